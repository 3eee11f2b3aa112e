// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/descriptor_distances.h"

#include <algorithm>
#include <cassert>

#include "frontend/features/dot_products.h"

namespace fabloop {
namespace {

std::vector<float> squared_norms(const cv::Mat& descriptors) {
  std::vector<float> norms(static_cast<std::size_t>(descriptors.rows));
  for (int r = 0; r < descriptors.rows; ++r) {
    const float* row = descriptors.ptr<float>(r);
    float sum = 0;
    for (int c = 0; c < descriptors.cols; ++c) sum += row[c] * row[c];
    norms[static_cast<std::size_t>(r)] = sum;
  }
  return norms;
}

}  // namespace

PackedDescriptors::PackedDescriptors(const cv::Mat& descriptors)
    : size_(static_cast<std::size_t>(descriptors.rows)),
      dimension_(static_cast<std::size_t>(descriptors.cols)),
      squared_norms_(squared_norms(descriptors)) {
  assert(descriptors.empty() || descriptors.type() == CV_32F);
  const std::size_t num_panels = (size_ + kPanelWidth - 1) / kPanelWidth;
  panels_.resize(num_panels * dimension_ * kPanelWidth, 0.0F);
  for (std::size_t m = 0; m < size_; ++m) {
    const float* row = descriptors.ptr<float>(static_cast<int>(m));
    float* panel = panels_.data() + (m / kPanelWidth) * dimension_ * kPanelWidth + m % kPanelWidth;
    for (std::size_t d = 0; d < dimension_; ++d) panel[d * kPanelWidth] = row[d];
  }
}

cv::Mat1f PackedDescriptors::squared_distances(const cv::Mat& queries) const {
  assert(queries.type() == CV_32F && static_cast<std::size_t>(queries.cols) == dimension_ && queries.isContinuous());
  const std::size_t num_panels = (size_ + kPanelWidth - 1) / kPanelWidth;
  const int padded = static_cast<int>(num_panels * kPanelWidth);
  cv::Mat1f products(queries.rows, padded);
  constexpr int kRowsAtOnce = 60;  // with a panel, they stay in the first-level cache
  for (int begin = 0; begin < queries.rows; begin += kRowsAtOnce) {
    const auto num_rows = static_cast<std::size_t>(std::min(kRowsAtOnce, queries.rows - begin));
    for (std::size_t panel = 0; panel < num_panels; ++panel) {
      dot_products(queries.ptr<float>(begin), num_rows, dimension_, panels_.data() + panel * dimension_ * kPanelWidth,
                   products.ptr<float>(begin) + panel * kPanelWidth, static_cast<std::size_t>(padded));
    }
  }
  const std::vector<float> query_norms = squared_norms(queries);
  for (int q = 0; q < queries.rows; ++q) {
    float* row = products.ptr<float>(q);
    const float query_norm = query_norms[static_cast<std::size_t>(q)];
    for (std::size_t m = 0; m < size_; ++m) row[m] = std::max(0.0F, query_norm + squared_norms_[m] - 2.0F * row[m]);
  }
  return products.colRange(0, static_cast<int>(size_));
}

}  // namespace fabloop
