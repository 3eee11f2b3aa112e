// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/epipolar_pencil.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

/// Rays nearer to the baseline than the last ring's upper end are candidates at any angle.
constexpr std::size_t kNumRings = 8;

std::size_t ring_of(double sine) {
  const double octave = -std::log2(std::max(sine, 1e-9));
  return std::min(static_cast<std::size_t>(std::max(octave, 0.0)), kNumRings - 1);
}

}  // namespace

EpipolarPencil::EpipolarPencil(std::span<const Eigen::Vector3d> match_rays, const Pose& match_from_query, double max_error_rad)
    : match_rays_(match_rays),
      rotation_(match_from_query.rotation.toRotationMatrix()),
      direction_(match_from_query.translation.normalized()),
      side_(direction_.unitOrthogonal()),
      over_(direction_.cross(side_)),
      max_error_rad_(max_error_rad),
      rings_(kNumRings) {
  assert(match_from_query.translation.norm() > 0);
  for (std::size_t ring = 0; ring + 1 < kNumRings; ++ring) rings_[ring].min_sine = std::exp2(-static_cast<double>(ring + 1));
  for (std::size_t i = 0; i < match_rays.size(); ++i) {
    const double sine = match_rays[i].cross(direction_).norm();
    rings_[ring_of(sine)].entries.push_back({angle_of(match_rays[i]), static_cast<int>(i)});
  }
  for (Ring& ring : rings_) {
    std::sort(ring.entries.begin(), ring.entries.end(),
              [](const Entry& a, const Entry& b) { return a.angle != b.angle ? a.angle < b.angle : a.index < b.index; });
  }
}

double EpipolarPencil::angle_of(const Eigen::Vector3d& ray) const { return std::atan2(ray.dot(over_), ray.dot(side_)); }

bool EpipolarPencil::is_candidate(const Eigen::Vector3d& turned_query_ray, const Eigen::Vector3d& match_ray) const {
  // Sampson distance on the unit sphere: e / |gradient of e on both tangent planes|.
  const Eigen::Vector3d from_query = direction_.cross(turned_query_ray);
  const Eigen::Vector3d from_match = match_ray.cross(direction_);
  const double error = match_ray.dot(from_query);
  const double squared_gradient = from_query.squaredNorm() + from_match.squaredNorm() - 2.0 * error * error;
  if (error * error > max_error_rad_ * max_error_rad_ * squared_gradient) return false;
  const RayDepths depths = ray_depths(turned_query_ray, match_ray, direction_);
  const bool meets_in_front = depths.query > 0 && depths.match > 0;
  return meets_in_front || (turned_query_ray - match_ray).norm() < 2.0 * max_error_rad_;
}

void EpipolarPencil::candidates_between(const Ring& ring, double low, double high, const Eigen::Vector3d& turned_query_ray,
                                        std::vector<int>& found) const {
  auto entry = std::lower_bound(ring.entries.begin(), ring.entries.end(), low,
                                [](const Entry& e, double angle) { return e.angle < angle; });
  for (; entry != ring.entries.end() && entry->angle <= high; ++entry) {
    if (is_candidate(turned_query_ray, match_rays_[static_cast<std::size_t>(entry->index)])) found.push_back(entry->index);
  }
}

void EpipolarPencil::candidates(const Eigen::Vector3d& query_ray, std::vector<int>& found) const {
  constexpr double kRounding = 1e-9;
  const Eigen::Vector3d turned = rotation_ * query_ray;
  const double angle = angle_of(turned);
  const double query_sine = turned.cross(direction_).norm();
  for (const Ring& ring : rings_) {
    const double sine = std::min(ring.min_sine, query_sine) > 0
                            ? max_error_rad_ * std::hypot(1.0 / ring.min_sine, 1.0 / query_sine)
                            : std::numeric_limits<double>::infinity();
    // So near the baseline, rays that are parallel to within the tolerance may lie on both of its sides.
    constexpr double kNearBaseline = 0.5;
    const double width = sine < kNearBaseline ? std::asin(sine) + kRounding : kPi;
    if (width == kPi) {
      candidates_between(ring, -kPi, kPi, turned, found);
      continue;
    }
    candidates_between(ring, angle - width, angle + width, turned, found);
    if (angle - width < -kPi) candidates_between(ring, angle - width + 2.0 * kPi, kPi, turned, found);
    if (angle + width > kPi) candidates_between(ring, -kPi, angle + width - 2.0 * kPi, turned, found);
  }
}

}  // namespace fabloop
