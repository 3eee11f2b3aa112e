// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/triangulation.h"

#include <cmath>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/triangulation/methods.hpp>

namespace fabloop {
std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& ray_in_a, const Eigen::Vector3d& ray_in_b, const Pose& a_from_b,
                                           const TriangulationOptions& options) {
  const Eigen::Vector3d b_ray_in_a = a_from_b.rotation * ray_in_b;
  if (angle_between(ray_in_a, b_ray_in_a) < rad_from_deg(options.min_parallax_deg)) return std::nullopt;
  const opengv::bearingVectors_t rays_in_a{ray_in_a};
  const opengv::bearingVectors_t rays_in_b{ray_in_b};
  const opengv::translation_t translation = a_from_b.translation;
  const opengv::rotation_t rotation = a_from_b.rotation.toRotationMatrix();
  opengv::relative_pose::CentralRelativeAdapter adapter(rays_in_a, rays_in_b, translation, rotation);
  const Eigen::Vector3d x_in_a = opengv::triangulation::triangulate2(adapter, 0);
  if (!x_in_a.allFinite()) return std::nullopt;
  const bool agrees = angle_between(ray_in_a, x_in_a) < options.max_error_rad &&
                      angle_between(b_ray_in_a, x_in_a - a_from_b.translation) < options.max_error_rad;
  if (!agrees) return std::nullopt;
  return x_in_a;
}

}  // namespace fabloop
