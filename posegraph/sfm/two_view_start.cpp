// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/two_view_start.h"

#include <algorithm>
#include <numeric>

#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {
namespace {

double start_score(const ViewPair& pair, const TwoViewStartOptions& options) {
  if (pair.median_parallax_deg < options.min_parallax_deg || pair.rotation_share > options.max_rotation_share) return 0.0;
  const double parallax = std::min(1.0, pair.median_parallax_deg / options.good_parallax_deg);
  return static_cast<double>(pair.inliers.size()) * parallax;
}

}  // namespace

std::vector<std::size_t> start_order(const std::vector<ViewPair>& pairs, const TwoViewStartOptions& options) {
  std::vector<double> scores;
  for (const ViewPair& pair : pairs) scores.push_back(start_score(pair, options));
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::erase_if(order, [&](std::size_t i) { return scores[i] <= 0.0; });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (pairs[a].has_rival != pairs[b].has_rival) return pairs[b].has_rival;
    return scores[a] > scores[b];
  });
  return order;
}

std::optional<Segment> start_segment(const Scene& scene, const ViewPair& pair, const TwoViewStartOptions& options) {
  Segment segment = empty_segment(scene);
  segment.world_from_cameras[pair.match] = Pose{};
  segment.world_from_cameras[pair.query] = pair.match_from_query;
  refresh_points(scene, segment, scene.tracks.of_view[pair.query], options.triangulation);
  if (num_points(segment) < options.min_points) return std::nullopt;
  adjust_segment(scene, segment);
  refresh_points(scene, segment, scene.tracks.of_view[pair.query], options.triangulation);
  if (num_points(segment) < options.min_points) return std::nullopt;
  return segment;
}

}  // namespace fabloop
