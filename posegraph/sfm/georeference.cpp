// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/georeference.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "verification/pose/alignment.h"

namespace fabloop {
namespace {

/// Extents of the cameras' centres (roots of their second moments), ascending.
Eigen::Vector3d extents(const std::vector<PointPair>& pairs) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PointPair& pair : pairs) mean += pair.in_query / static_cast<double>(pairs.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) scatter += (pair.in_query - mean) * (pair.in_query - mean).transpose();
  scatter /= static_cast<double>(pairs.size());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

GeoreferenceResult georeference(const Segment& segment, const std::vector<std::optional<Eigen::Vector3d>>& known_positions,
                                const GeoreferenceOptions& options) {
  std::vector<PointPair> pairs;
  for (std::size_t view = 0; view < known_positions.size(); ++view) {
    if (!known_positions[view] || !segment.world_from_cameras[view]) continue;
    pairs.push_back({segment.world_from_cameras[view]->translation, *known_positions[view]});
  }
  constexpr std::size_t kLeastPositions = 5;
  if (pairs.size() < kLeastPositions) {
    return {std::nullopt, "only " + std::to_string(pairs.size()) + " placed images have a known position"};
  }
  const Eigen::Vector3d extent = extents(pairs);
  if (!(extent(1) > options.min_width * extent(2))) {
    return {std::nullopt, "the cameras lie on one line, about which their positions leave the map free to turn"};
  }
  AlignmentOptions alignment;
  alignment.scale = AlignmentScale::Free;
  constexpr double kMapNoise = 1e-3;  // of the map's extent: what structure from motion errs by, far below a GPS's noise
  alignment.query_noise = {kMapNoise * extent(2), 0.0, 0.0, 0.0};
  alignment.match_noise = {options.sigma_m, 0.0, 0.0, 0.0};
  alignment.seed = options.seed;
  const auto found = align_points(pairs, alignment);
  const auto enough = options.min_inlier_share * static_cast<double>(pairs.size());
  if (!found || static_cast<double>(found->inliers.size()) < enough) {
    return {std::nullopt, "fewer than half of the known positions agree with the map"};
  }
  Georeference result{found->scale, found->match_from_query, pairs.size(), found->inliers.size()};
  std::vector<double> distances;
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d moved =
        found->scale * (found->match_from_query.rotation * pair.in_query) + found->match_from_query.translation;
    distances.push_back((moved - pair.in_match).norm());
  }
  for (const std::size_t i : found->inliers) result.rms_m += distances[i] * distances[i];
  result.rms_m = std::sqrt(result.rms_m / static_cast<double>(result.num_inliers));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  result.median_m = *middle;
  return {result, {}};
}

void move_segment(Segment& segment, double scale, const Pose& new_from_old) {
  const auto moved = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return scale * (new_from_old.rotation * x) + new_from_old.translation;
  };
  for (auto& pose : segment.world_from_cameras) {
    if (pose) pose = Pose{(new_from_old.rotation * pose->rotation).normalized(), moved(pose->translation)};
  }
  for (ReadoutMotion& motion : segment.readout_motions) {
    motion.shift_in_world = scale * (new_from_old.rotation * motion.shift_in_world);
  }
  for (auto& point : segment.points) {
    if (point) point->x_in_world = moved(point->x_in_world);
  }
}

}  // namespace fabloop
