// SPDX-License-Identifier: BSD-3-Clause
#include "data/pair_overlap.h"

#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double signed_area(const Footprint& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return 0.5 * twice;
}

/// The part of a convex polygon on the left of the line from `a` to `b` (Sutherland and Hodgman 1974).
Footprint clip(const Footprint& polygon, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Footprint inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& from = polygon[i];
    const Eigen::Vector2d& to = polygon[(i + 1) % polygon.size()];
    const double from_side = cross(b - a, from - a);
    const double to_side = cross(b - a, to - a);
    if (from_side >= 0) inside.push_back(from);
    if ((from_side > 0 && to_side < 0) || (from_side < 0 && to_side > 0)) {
      inside.push_back(from + (to - from) * (from_side / (from_side - to_side)));
    }
  }
  return inside;
}

}  // namespace

Footprint ground_footprint(const HeightMap& terrain, const Camera& camera, const Pose& world_from_camera) {
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  Footprint footprint;
  for (const auto& ray : bearings(camera, {{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}})) {
    const Eigen::Vector3d ray_in_world = world_from_camera.rotation * ray;
    const auto distance = intersect(terrain, world_from_camera.translation, ray_in_world);
    if (!distance) return {};
    footprint.push_back((world_from_camera.translation + *distance * ray_in_world).head<2>());
  }
  // The picture's corners run clockwise; seen from above, the ground's may run either way.
  if (signed_area(footprint) < 0) std::reverse(footprint.begin(), footprint.end());
  return footprint;
}

double area_of(const Footprint& footprint) { return footprint.size() < 3 ? 0.0 : std::abs(signed_area(footprint)); }

double overlap(const Footprint& a, const Footprint& b) {
  const double smaller = std::min(area_of(a), area_of(b));
  if (!(smaller > 0)) return 0;
  Footprint common = a;
  for (std::size_t i = 0; i < b.size() && !common.empty(); ++i) common = clip(common, b[i], b[(i + 1) % b.size()]);
  return std::clamp(area_of(common) / smaller, 0.0, 1.0);
}

std::vector<OverlappingPair> overlapping_pairs(const HeightMap& terrain, const Camera& camera,
                                               const std::vector<Pose>& world_from_camera, std::size_t min_gap,
                                               double min_overlap) {
  std::vector<Footprint> footprints;
  for (const auto& pose : world_from_camera) footprints.push_back(ground_footprint(terrain, camera, pose));
  std::vector<OverlappingPair> pairs;
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    for (std::size_t j = i + min_gap + 1; j < footprints.size(); ++j) {
      const double shared = overlap(footprints[i], footprints[j]);
      if (shared < min_overlap) continue;
      const double distance_m = (world_from_camera[i].translation - world_from_camera[j].translation).norm();
      pairs.push_back({i, j, distance_m, shared});
    }
  }
  return pairs;
}

}  // namespace fabloop
