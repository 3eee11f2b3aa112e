// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "frontend/fabmap/row_search.h"
#include "frontend/features/dot_products.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

constexpr std::size_t kBatchSize = 1024;  ///< Points searched together: enough that several visit the same cell.
constexpr float kMaxFloat = std::numeric_limits<float>::max();
constexpr std::size_t kVisitedPart = 8;  ///< One of so many cells.
constexpr std::size_t kMinVisited = 4;

/// Points that stay in the first-level cache together with a panel: a multiple of the six that the kernel takes at once.
std::size_t block_size(std::size_t num_coordinates) { return std::clamp<std::size_t>(4096 / num_coordinates, 6, 120) / 6 * 6; }

/// The squared distance's own error, its bound's, and the one of their difference, for norms that add up to `norms`: each
/// sum of n products of single precision is off by at most n 2^-24 of the sum of their magnitudes, which is below norms^2.
double rounding_margin(std::size_t dimension, std::size_t num_coordinates, double norms) {
  constexpr double kHalfUnit = 0x1p-24;
  return 2.0 * static_cast<double>(dimension + num_coordinates + 32) * kHalfUnit * norms * norms;
}

}  // namespace

/// Points on their way to their nearest rows.
struct RowSearch::Batch {
  cv::Mat points;
  std::vector<float> coordinates;        ///< N x num_coordinates_.
  std::vector<double> offsets;           ///< What a row's product must stay below, less the best squared distance.
  std::vector<float> limits;             ///< What a row's product must stay below.
  std::vector<float> squared_distances;  ///< Of the best row so far.
  std::vector<std::uint32_t> rows;       ///< The best so far.
  Keep keep = Keep::Nearest;
  std::vector<float> second_squared_distances;  ///< Of the second best so far.
  std::vector<std::uint32_t> second_rows;       ///< The second best so far.
  std::vector<std::uint32_t> nearest_cells;     ///< N.
  std::vector<std::uint32_t> other_cells;       ///< About an eighth of all for each point, the next nearest.
  std::vector<std::size_t> other_starts;        ///< Of each point in other_cells, and the end of the last.
  std::vector<float> block_coordinates;         ///< Of scan().
  std::vector<float> block_limits;              ///< Of scan().
  std::vector<PanelHit> hits;                   ///< Of scan().

  std::size_t size() const { return rows.size(); }
};

void RowSearch::start(Batch& batch, const cv::Mat& points, std::span<const std::uint32_t> guesses) const {
  const auto size = static_cast<std::size_t>(points.rows);
  batch.points = points;
  batch.coordinates.resize(size * num_coordinates_);
  batch.offsets.resize(size);
  batch.limits.resize(size);
  batch.squared_distances.assign(size, std::numeric_limits<float>::infinity());
  batch.rows.assign(size, kNoRow);
  batch.second_squared_distances.assign(size, std::numeric_limits<float>::infinity());
  batch.second_rows.assign(size, kNoRow);
  for (std::size_t i = 0; i < size; ++i) {
    const auto* point = points.ptr<float>(static_cast<int>(i));
    const std::span<float> coordinates(batch.coordinates.data() + i * num_coordinates_, num_coordinates_);
    if (projection_) {
      projection_->project(point, coordinates.data());
    } else {
      std::copy_n(point, points.cols, coordinates.data());
    }
    const double squared_norm = append_squared_norm(coordinates);
    for (float& value : coordinates) value *= -2.0F;
    coordinates.back() = 1.0F;
    const double norms = std::sqrt(squared_norm) + static_cast<double>(max_norm_);
    batch.offsets[i] = rounding_margin(static_cast<std::size_t>(points.cols), num_coordinates_, norms) - squared_norm;
    consider(batch, i, guesses.empty() ? 0u : guesses[i]);
  }
}

/// Takes the row if it is nearer than the best so far, or as near and lower; or as the second best, where that is kept.
void RowSearch::consider(Batch& batch, std::size_t point, std::uint32_t row) const {
  if (row == kNoRow || row == batch.rows[point] || row == batch.second_rows[point]) return;
  const float distance = squared_distance(batch.points.ptr<float>(static_cast<int>(point)),
                                          rows_.ptr<float>(static_cast<int>(row)), static_cast<std::size_t>(rows_.cols));
  const float best = batch.squared_distances[point];
  const bool is_first = batch.rows[point] == kNoRow;
  const bool is_best = is_first || distance < best || (distance == best && row < batch.rows[point]);
  const bool is_second = !is_best && batch.keep == Keep::TwoNearest && distance < batch.second_squared_distances[point];
  if (!is_best && !is_second) return;
  if (batch.keep == Keep::TwoNearest) {
    batch.second_squared_distances[point] = is_best ? best : distance;
    batch.second_rows[point] = is_best ? batch.rows[point] : row;
  }
  if (is_best) {
    batch.squared_distances[point] = distance;
    batch.rows[point] = row;
  }
  const float worst_kept = batch.keep == Keep::TwoNearest ? batch.second_squared_distances[point] : distance;
  const auto limit = static_cast<float>(batch.offsets[point] + static_cast<double>(worst_kept));
  batch.limits[point] = std::isfinite(limit) ? limit : kMaxFloat;
}

/// Rows are looked at in no order that a processor could foresee.
void RowSearch::prefetch(std::uint32_t row) const {
#if defined(__GNUC__)
  if (row == kNoRow) return;
  constexpr int kFloatsPerLine = 16;
  const auto* numbers = rows_.ptr<float>(static_cast<int>(row));
  for (int i = 0; i < rows_.cols; i += kFloatsPerLine) __builtin_prefetch(numbers + i);
#endif
}

/// Compares the members of a batch with the rows of some panels.
void RowSearch::scan(Batch& batch, std::span<const std::uint32_t> members, std::size_t begin, std::size_t end) const {
  const std::size_t size = block_size(num_coordinates_);
  batch.block_coordinates.resize(size * num_coordinates_);
  batch.block_limits.resize(size);
  batch.hits.resize(size * kPanelWidth + 1);
  std::vector<float>&coordinates = batch.block_coordinates, &limits = batch.block_limits;
  std::vector<PanelHit>& hits = batch.hits;
  for (; !members.empty(); members = members.subspan(std::min(size, members.size()))) {
    const auto block = members.first(std::min(size, members.size()));
    for (std::size_t i = 0; i < block.size(); ++i) {
      std::copy_n(batch.coordinates.data() + block[i] * num_coordinates_, num_coordinates_,
                  coordinates.data() + i * num_coordinates_);
      limits[i] = batch.limits[block[i]];
    }
    for (std::size_t panel = begin; panel < end; ++panel) {
      const std::size_t num_hits =
          dot_products_within(coordinates.data(), block.size(), num_coordinates_,
                              panels_.data() + panel * num_coordinates_ * kPanelWidth, limits.data(), hits.data());
      for (std::size_t i = 0; i < num_hits; ++i) prefetch(rows_of_slots_[panel * kPanelWidth + hits[i].column]);
      for (std::size_t i = 0; i < num_hits; ++i) {
        consider(batch, block[hits[i].row], rows_of_slots_[panel * kPanelWidth + hits[i].column]);
        limits[hits[i].row] = batch.limits[block[hits[i].row]];
      }
    }
  }
}

void RowSearch::scan_all(Batch& batch) const {
  std::vector<std::uint32_t> all(batch.size());
  std::iota(all.begin(), all.end(), 0u);
  scan(batch, all, 0, num_panels());
}

namespace {

/// A number that about `wanted` of the others do not exceed, found by halving: never fewer, and more only where they are close.
float limit_for(std::span<const float> numbers, std::size_t wanted) {
  constexpr int kHalvings = 9;
  const auto [min, max] = std::minmax_element(numbers.begin(), numbers.end());
  float low = *min, high = *max;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = 0.5F * (low + high);
    std::int32_t count = 0;
    for (const float number : numbers) count += number <= middle ? 1 : 0;
    (static_cast<std::size_t>(count) >= wanted ? high : low) = middle;
  }
  return high;
}

/// Points by the cell that they visit.
struct Visits {
  std::vector<std::size_t> starts;  ///< Of each cell in points, and the end of the last.
  std::vector<std::uint32_t> points;

  std::span<const std::uint32_t> of(std::size_t cell) const {
    return {points.data() + starts[cell], starts[cell + 1] - starts[cell]};
  }
};

/// Point i visits the cells [starts[i], starts[i + 1]) of `cells`.
template <typename Starts>
Visits visits_of(const std::vector<std::uint32_t>& cells, const Starts& starts, std::size_t num_points, std::size_t num_cells) {
  Visits visits;
  visits.starts.assign(num_cells + 2, 0);  // One further than the cell: filling moves each to where it belongs.
  for (const std::uint32_t cell : cells) ++visits.starts[cell + 2];
  std::partial_sum(visits.starts.begin(), visits.starts.end(), visits.starts.begin());
  visits.points.resize(cells.size());
  for (std::size_t i = 0; i < num_points; ++i) {
    for (std::size_t j = starts(i); j < starts(i + 1); ++j) {
      visits.points[visits.starts[cells[j] + 1]++] = static_cast<std::uint32_t>(i);
    }
  }
  return visits;
}

}  // namespace

/// Finds for each point the cells whose centres are nearest.
void RowSearch::rank_cells(Batch& batch) const {
  const std::size_t padded = (cells_.size() + kPanelWidth - 1) / kPanelWidth * kPanelWidth;
  std::vector<float> products(batch.size() * padded);
  for (std::size_t panel = 0; panel * kPanelWidth < padded; ++panel) {
    dot_products(batch.coordinates.data(), batch.size(), num_coordinates_,
                 cell_panels_.data() + panel * num_coordinates_ * kPanelWidth, products.data() + panel * kPanelWidth, padded);
  }
  const std::size_t wanted = std::min(cells_.size(), std::max(kMinVisited, cells_.size() / kVisitedPart));
  batch.other_starts.assign(1, 0);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::span<const float> to_cells(products.data() + i * padded, cells_.size());
    const auto nearest = static_cast<std::uint32_t>(std::min_element(to_cells.begin(), to_cells.end()) - to_cells.begin());
    const float limit = limit_for(to_cells, wanted);
    batch.nearest_cells.push_back(nearest);
    for (std::uint32_t cell = 0; cell < to_cells.size(); ++cell) {
      if (to_cells[cell] <= limit && cell != nearest) batch.other_cells.push_back(cell);
    }
    batch.other_starts.push_back(batch.other_cells.size());
  }
}

void RowSearch::visit_other_cells(Batch& batch) const {
  const auto starts = [&](std::size_t i) { return batch.other_starts[i]; };
  const Visits visits = visits_of(batch.other_cells, starts, batch.size(), cells_.size());
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) scan(batch, visits.of(cell), cells_[cell].begin, cells_[cell].end);
}

/// Begins with the row of lowest bound, so that few of the others need a closer look.
void RowSearch::visit_nearest_cells(Batch& batch) const {
  const auto starts = [](std::size_t i) { return i; };
  const Visits visits = visits_of(batch.nearest_cells, starts, batch.size(), cells_.size());
  std::vector<float> coordinates, products;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    const auto members = visits.of(cell);
    const std::size_t width = (cells_[cell].end - cells_[cell].begin) * kPanelWidth;
    if (members.empty() || width == 0) continue;
    coordinates.resize(members.size() * num_coordinates_);
    products.resize(members.size() * width);
    for (std::size_t i = 0; i < members.size(); ++i) {
      std::copy_n(batch.coordinates.data() + members[i] * num_coordinates_, num_coordinates_,
                  coordinates.data() + i * num_coordinates_);
    }
    for (std::size_t panel = 0; panel * kPanelWidth < width; ++panel) {
      dot_products(coordinates.data(), members.size(), num_coordinates_,
                   panels_.data() + (cells_[cell].begin + panel) * num_coordinates_ * kPanelWidth,
                   products.data() + panel * kPanelWidth, width);
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
      const float* row = products.data() + i * width;
      const auto slot = static_cast<std::size_t>(std::min_element(row, row + width) - row);
      consider(batch, members[i], rows_of_slots_[cells_[cell].begin * kPanelWidth + slot]);
    }
    scan(batch, members, cells_[cell].begin, cells_[cell].end);
  }
}

template <typename Search>
NearestRows RowSearch::in_batches(const cv::Mat& points, int num_threads, Keep keep, const Search& search) const {
  assert(points.rows == 0 || (points.cols == rows_.cols && points.type() == CV_32FC1 && points.isContinuous()));
  const auto size = static_cast<std::size_t>(points.rows);
  const std::size_t num_seconds = keep == Keep::TwoNearest ? size : 0;
  NearestRows result{std::vector<std::uint32_t>(size), std::vector<float>(size), std::vector<std::uint32_t>(num_seconds),
                     std::vector<float>(num_seconds)};
  parallel_for((size + kBatchSize - 1) / kBatchSize, num_threads, [&](std::size_t index) {
    const std::size_t begin = index * kBatchSize;
    const std::size_t end = std::min(begin + kBatchSize, size);
    Batch batch;
    batch.keep = keep;
    search(batch, points.rowRange(static_cast<int>(begin), static_cast<int>(end)), begin);
    const auto place = static_cast<std::ptrdiff_t>(begin);
    std::copy(batch.rows.begin(), batch.rows.end(), result.row.begin() + place);
    std::copy(batch.squared_distances.begin(), batch.squared_distances.end(), result.squared_distance.begin() + place);
    if (keep == Keep::Nearest) return;
    std::copy(batch.second_rows.begin(), batch.second_rows.end(), result.second_row.begin() + place);
    std::copy(batch.second_squared_distances.begin(), batch.second_squared_distances.end(),
              result.second_squared_distance.begin() + place);
  });
  return result;
}

NearestRows RowSearch::nearest(const cv::Mat& points, int num_threads, std::span<const std::uint32_t> guesses) const {
  return in_batches(points, num_threads, Keep::Nearest, [&](Batch& batch, const cv::Mat& some, std::size_t begin) {
    start(batch, some, guesses.empty() ? guesses : guesses.subspan(begin, static_cast<std::size_t>(some.rows)));
    if (guesses.empty() && !cells_.empty()) {
      rank_cells(batch);
      visit_nearest_cells(batch);
      visit_other_cells(batch);
    }
    scan_all(batch);
  });
}

/// A bound is reached where two remainders point the same way, which they hardly ever do: twice the product of their lengths
/// times one less the cosine is missing from it. Here, half of that product is expected at least.
void RowSearch::expect_remainders_to_differ(Batch& batch) const {
  constexpr float kMaxCosine = 0.6F;
  for (std::size_t i = 0; i < batch.size(); ++i) batch.coordinates[(i + 1) * num_coordinates_ - 2] *= kMaxCosine;
}

void RowSearch::search_near(Batch& batch, const cv::Mat& points, std::span<const std::uint32_t> guesses) const {
  start(batch, points, guesses);
  if (cells_.empty()) return scan_all(batch);
  expect_remainders_to_differ(batch);
  rank_cells(batch);
  visit_nearest_cells(batch);
  visit_other_cells(batch);
}

NearestRows RowSearch::near(const cv::Mat& points, int num_threads, std::span<const std::uint32_t> guesses) const {
  return in_batches(points, num_threads, Keep::Nearest, [&](Batch& batch, const cv::Mat& some, std::size_t begin) {
    search_near(batch, some, guesses.empty() ? guesses : guesses.subspan(begin, static_cast<std::size_t>(some.rows)));
  });
}

NearestRows RowSearch::near_two(const cv::Mat& points, int num_threads) const {
  return in_batches(points, num_threads, Keep::TwoNearest,
                    [&](Batch& batch, const cv::Mat& some, std::size_t) { search_near(batch, some, {}); });
}

}  // namespace fabloop
