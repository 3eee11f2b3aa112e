// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/cluster_means.h"
#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/vocabulary_training.h"

namespace fabloop {
namespace {

cv::Mat chosen_rows(const cv::Mat& points, const std::vector<std::size_t>& rows) {
  cv::Mat result(static_cast<int>(rows.size()), points.cols, CV_32F);
  for (std::size_t i = 0; i < rows.size(); ++i) points.row(static_cast<int>(rows[i])).copyTo(result.row(static_cast<int>(i)));
  return result;
}

/// Moves each centre without points to one of the points furthest from theirs. Returns how many were moved.
std::size_t restart_empty(cv::Mat& centres, const std::vector<std::size_t>& sizes, const cv::Mat& points,
                          const std::vector<float>& squared_distances) {
  const auto num_empty = static_cast<std::size_t>(std::count(sizes.begin(), sizes.end(), std::size_t{0}));
  if (num_empty == 0) return 0;
  std::vector<std::size_t> furthest(squared_distances.size());
  std::iota(furthest.begin(), furthest.end(), std::size_t{0});
  const std::size_t wanted = std::min(num_empty, furthest.size());
  std::partial_sort(furthest.begin(), furthest.begin() + static_cast<std::ptrdiff_t>(wanted), furthest.end(),
                    [&](std::size_t a, std::size_t b) {
                      return squared_distances[a] != squared_distances[b] ? squared_distances[a] > squared_distances[b] : a < b;
                    });
  std::size_t moved = 0;
  for (std::size_t centre = 0; centre < sizes.size() && moved < wanted; ++centre) {
    if (sizes[centre] > 0) continue;
    if (squared_distances[furthest[moved]] <= 0.0f) break;
    points.row(static_cast<int>(furthest[moved++])).copyTo(centres.row(static_cast<int>(centre)));
  }
  return moved;
}

/// The centres that some point is nearest to.
cv::Mat without_empty(const cv::Mat& centres, const std::vector<std::uint32_t>& nearest) {
  std::vector<char> used(static_cast<std::size_t>(centres.rows), 0);
  for (const std::uint32_t row : nearest) used[row] = 1;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) kept.push_back(i);
  }
  return chosen_rows(centres, kept);
}

}  // namespace

Vocabulary train_k_means(const cv::Mat& descriptors, const KMeansOptions& options) {
  if (descriptors.empty()) throw InputError("there are no descriptors to make words of; train on images with more texture");
  if (options.num_words == 0) throw InputError("a vocabulary needs at least one word");
  const cv::Mat points = float_descriptors(descriptors);
  const auto num_points = static_cast<std::size_t>(points.rows);
  cv::Mat centres = chosen_rows(points, sample_without_replacement(num_points, options.num_words, options.seed));
  std::vector<std::uint32_t> assignment;
  double last_inertia = 0.0;
  int iteration = 0;
  if (options.start) {
    options.start->centres.copyTo(centres);
    assignment = options.start->assignment;
    last_inertia = options.start->inertia;
    iteration = options.start->num_iterations;
  }
  for (; iteration < options.max_iterations; ++iteration) {
    const NearestRows nearest = search_for(centres, points.rows).near(points, options.num_threads, assignment);
    const std::vector<std::size_t> sizes = move_to_means(centres, points, nearest.row, options.num_threads);
    assignment = nearest.row;
    const std::size_t restarted = restart_empty(centres, sizes, points, nearest.squared_distance);
    const double inertia = std::accumulate(nearest.squared_distance.begin(), nearest.squared_distance.end(), 0.0);
    if (options.progress) {
      options.progress("k-means", static_cast<std::size_t>(iteration) + 1, static_cast<std::size_t>(options.max_iterations));
    }
    const bool converged = iteration > 0 && last_inertia - inertia <= options.min_improvement * last_inertia;
    if (converged && restarted == 0) break;
    last_inertia = inertia;
    if (options.after_iteration) options.after_iteration({iteration + 1, centres, assignment, inertia});
  }
  if (options.progress) options.progress("k-means", 1, 1);
  assignment = search_for(centres, points.rows).nearest(points, options.num_threads, assignment).row;
  move_to_means(centres, points, assignment, options.num_threads);
  assignment = search_for(centres, points.rows).nearest(points, options.num_threads, assignment).row;
  return {without_empty(centres, assignment)};
}

}  // namespace fabloop
