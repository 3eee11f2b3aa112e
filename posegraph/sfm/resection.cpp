// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/resection.h"

#include <algorithm>
#include <cmath>

#include "verification/pair_seed.h"
#include "verification/pose/absolute_pose.h"

namespace fabloop {

Visibility visibility(const Scene& scene, const Segment& segment, std::size_t view) {
  constexpr std::size_t kFinest = 16;
  std::vector<char> has_point(kFinest * kFinest, 0);
  const Camera& camera = scene.views[view].camera;
  Visibility result;
  const auto cell = [](double x, int size) {
    const double share = std::clamp(x / size, 0.0, 1.0 - 1e-9);
    return static_cast<std::size_t>(share * static_cast<double>(kFinest));
  };
  for (const std::uint32_t t : scene.tracks.of_view[view]) {
    if (!segment.points[t]) continue;
    ++result.num_points;
    const Track& track = scene.tracks.tracks[t];
    const Eigen::Vector2d pixel = pixel_of(scene, track[*position_in(track, view)]);
    has_point[cell(pixel.y(), camera.height) * kFinest + cell(pixel.x(), camera.width)] = 1;
  }
  for (std::size_t side = kFinest; side >= 2; side /= 2) {
    const std::size_t step = kFinest / side;
    std::vector<char> coarse(side * side, 0);
    for (std::size_t i = 0; i < has_point.size(); ++i) {
      if (has_point[i] != 0) coarse[(i / kFinest / step) * side + (i % kFinest) / step] = 1;
    }
    result.score += side * side * static_cast<std::size_t>(std::count(coarse.begin(), coarse.end(), 1));
  }
  return result;
}

std::optional<Pose> resect(const Scene& scene, const Segment& segment, std::size_t view, const ResectionOptions& options) {
  std::vector<std::uint32_t> visible;
  for (const std::uint32_t t : scene.tracks.of_view[view]) {
    if (segment.points[t]) visible.push_back(t);
  }
  if (visible.size() < options.min_inliers) return std::nullopt;
  // Points that many views agree on are the most reliable.
  std::stable_sort(visible.begin(), visible.end(), [&](std::uint32_t a, std::uint32_t b) {
    return segment.points[a]->seen_by.size() > segment.points[b]->seen_by.size();
  });
  std::vector<PointRay> data;
  for (const std::uint32_t t : visible) {
    const Track& track = scene.tracks.tracks[t];
    data.push_back({segment.points[t]->x_in_world, scene.views[view].rays[track[*position_in(track, view)].feature]});
  }
  AbsolutePoseOptions pose_options;
  pose_options.max_error_rad = options.max_error_px / feature_focal_px(scene.views[view]);
  pose_options.max_iterations = options.max_iterations;
  pose_options.seed = pair_seed(options.seed, view, data.size());
  const auto found = estimate_absolute_pose(data, pose_options);
  if (!found || found->inliers.size() < options.min_inliers) return std::nullopt;
  if (static_cast<double>(found->inliers.size()) < options.min_inlier_share * static_cast<double>(data.size()))
    return std::nullopt;
  return found->world_from_camera;
}

}  // namespace fabloop
