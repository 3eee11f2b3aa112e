// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/descriptor_distances.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "frontend/features/dot_products.h"
#include "frontend/features/row_minima.h"

namespace fabloop {
namespace {

static_assert(kPanelWidth == kRowStep);

/// The rows as columns of a panel, and their squared norms.
void pack(const cv::Mat& descriptors, int first_row, float* panel, float* squared_norms) {
  std::array<const float*, kPanelWidth> rows{};
  const auto num_rows = static_cast<std::size_t>(std::min(descriptors.rows - first_row, static_cast<int>(kPanelWidth)));
  for (std::size_t j = 0; j < num_rows; ++j) rows[j] = descriptors.ptr<float>(first_row + static_cast<int>(j));
  std::array<float, kPanelWidth> norms{};
  for (std::size_t d = 0; d < static_cast<std::size_t>(descriptors.cols); ++d) {
    float* column = panel + d * kPanelWidth;
    for (std::size_t j = 0; j < num_rows; ++j) column[j] = rows[j][d];
    for (std::size_t j = 0; j < kPanelWidth; ++j) norms[j] += column[j] * column[j];
  }
  for (std::size_t j = 0; j < kPanelWidth; ++j) {
    squared_norms[j] = j < num_rows ? norms[j] : std::numeric_limits<float>::infinity();
  }
}

/// Of several rows at a time: the sums of one would wait for each other.
std::vector<float> squared_norms_of(const cv::Mat& descriptors) {
  constexpr std::size_t kRows = 8;
  const auto size = static_cast<std::size_t>(descriptors.rows), dimension = static_cast<std::size_t>(descriptors.cols);
  std::vector<float> norms(size);
  const float* rows = descriptors.ptr<float>();
  for (std::size_t begin = 0; begin < size; begin += kRows) {
    const std::size_t count = std::min(kRows, size - begin);
    std::array<const float*, kRows> row{};
    for (std::size_t j = 0; j < kRows; ++j) row[j] = rows + (begin + std::min(j, count - 1)) * dimension;
    std::array<float, kRows> sums{};
    for (std::size_t d = 0; d < dimension; ++d) {
      for (std::size_t j = 0; j < kRows; ++j) sums[j] += row[j][d] * row[j][d];
    }
    std::copy_n(sums.begin(), count, norms.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  return norms;
}

}  // namespace

PackedDescriptors::PackedDescriptors(const cv::Mat& descriptors)
    : size_(static_cast<std::size_t>(descriptors.rows)), dimension_(static_cast<std::size_t>(descriptors.cols)) {
  assert(descriptors.empty() || descriptors.type() == CV_32F);
  const std::size_t num_panels = (size_ + kPanelWidth - 1) / kPanelWidth;
  panels_.resize(num_panels * dimension_ * kPanelWidth, 0.0F);
  squared_norms_.resize(num_panels * kPanelWidth);
  for (std::size_t panel = 0; panel < num_panels; ++panel) {
    pack(descriptors, static_cast<int>(panel * kPanelWidth), panels_.data() + panel * dimension_ * kPanelWidth,
         squared_norms_.data() + panel * kPanelWidth);
  }
}

void PackedDescriptors::squared_distances(const cv::Mat& queries, float* distances) const {
  assert(queries.type() == CV_32F && static_cast<std::size_t>(queries.cols) == dimension_ && queries.isContinuous());
  constexpr std::size_t kRowsAtOnce = 60;  // with a panel, they stay in the first-level cache
  const auto num_queries = static_cast<std::size_t>(queries.rows);
  const float* rows = queries.ptr<float>();
  const std::vector<float> query_norms = squared_norms_of(queries);
  for (std::size_t begin = 0; begin < num_queries; begin += kRowsAtOnce) {
    const std::size_t num_rows = std::min(kRowsAtOnce, num_queries - begin);
    float* block = distances + begin * stride();
    for (std::size_t column = 0; column < stride(); column += kPanelWidth) {
      dot_products(rows + begin * dimension_, num_rows, dimension_, panels_.data() + column * dimension_, block + column,
                   stride());
    }
    for (std::size_t r = 0; r < num_rows; ++r) {
      squared_distances_from_products(block + r * stride(), stride(), query_norms[begin + r], squared_norms_.data());
    }
  }
}

cv::Mat1f PackedDescriptors::squared_distances(const cv::Mat& queries) const {
  cv::Mat1f distances(queries.rows, static_cast<int>(stride()));
  if (!distances.empty()) squared_distances(queries, distances.ptr<float>());
  return distances.colRange(0, static_cast<int>(size_));
}

}  // namespace fabloop
