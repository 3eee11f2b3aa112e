// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "frontend/fabmap/row_projection.h"

namespace fabloop {

/// For each of N points, which row is nearest and how far it is.
struct NearestRows {
  std::vector<std::uint32_t> row;                ///< N. The lower of rows equally far.
  std::vector<float> squared_distance;           ///< N, squared Euclidean, summed in single precision.
  std::vector<std::uint32_t> second_row{};       ///< N of near_two(), else empty. Meaningless where the distance is infinite.
  std::vector<float> second_squared_distance{};  ///< N of near_two(), else empty. Infinite where only one row was seen.
};

/// What a RowSearch is prepared for.
enum class RowSearchKind {
  Once,       ///< A few points: nothing is computed of the rows.
  ManyTimes,  ///< Many points: the rows are projected and sorted into cells, which takes as long as some 5,000 points.
};

/// Finds the rows nearest to points. Rows are compared by bounds in few dimensions (see RowProjection), from norms and
/// products; those that may be nearest by their differences. Safe in parallel. Keeps the rows' header: their numbers must not
/// change.
class RowSearch {
 public:
  /// `rows`: W x D, CV_32F, continuous, W >= 1.
  RowSearch(const cv::Mat& rows, RowSearchKind kind);

  /// Exhaustive: the bits of the result depend on neither kind nor threads. `guesses`, where given, names a row for each
  /// point; the nearer it is, the faster the search. `points`: N x D, CV_32F, continuous.
  NearestRows nearest(const cv::Mat& points, int num_threads, std::span<const std::uint32_t> guesses = {}) const;

  /// Looks only at the guess and into the cells nearest to each point, an eighth of all. Where the rows have no structure that a
  /// projection could use, it is exhaustive. Depends on neither threads nor the other points.
  NearestRows near(const cv::Mat& points, int num_threads, std::span<const std::uint32_t> guesses = {}) const;

  /// The same with the second nearest.
  NearestRows near_two(const cv::Mat& points, int num_threads) const;

 private:
  static constexpr std::uint32_t kNoRow = std::numeric_limits<std::uint32_t>::max();
  struct Batch;
  enum class Keep { Nearest, TwoNearest };
  struct Cell {
    std::size_t begin = 0, end = 0;  ///< Panels.
  };

  std::size_t num_panels() const;
  /// A row's coordinates are (c, |c|^2) and a point's (-2 c, 1), so that their product is the squared distance less |c|^2 of
  /// the point. Returns |c|^2.
  static double append_squared_norm(std::span<float> coordinates);
  void add_panels(std::span<const std::uint32_t> rows, const std::vector<float>& coordinates);
  void make_cells(const std::vector<float>& coordinates);
  void start(Batch& batch, const cv::Mat& points, std::span<const std::uint32_t> guesses) const;
  void rank_cells(Batch& batch) const;
  void expect_remainders_to_differ(Batch& batch) const;
  void visit_nearest_cells(Batch& batch) const;
  void visit_other_cells(Batch& batch) const;
  void scan(Batch& batch, std::span<const std::uint32_t> members, std::size_t begin, std::size_t end) const;
  void prefetch(std::uint32_t row) const;
  void scan_all(Batch& batch) const;
  void consider(Batch& batch, std::size_t point, std::uint32_t row) const;
  template <typename Search>
  NearestRows in_batches(const cv::Mat& points, int num_threads, Keep keep, const Search& search) const;
  void search_near(Batch& batch, const cv::Mat& points, std::span<const std::uint32_t> guesses) const;

  cv::Mat rows_;
  std::optional<RowProjection> projection_;
  std::size_t num_coordinates_ = 0;           ///< Of a row in panels_: its own, and its squared norm.
  float max_norm_ = 0.0F;                     ///< Of the rows' coordinates.
  std::vector<float> panels_;                 ///< num_coordinates_ x 16 numbers each.
  std::vector<std::uint32_t> rows_of_slots_;  ///< Which row stands in each column of the panels; kNoRow for none.
  std::vector<Cell> cells_;
  std::vector<float> cell_panels_;  ///< The cells' centres, laid out like panels_.
};

}  // namespace fabloop
