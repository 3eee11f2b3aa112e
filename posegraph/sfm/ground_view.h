// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// What is taken as up.
enum class UpDirection {
  Automatic,  ///< World z where the reconstruction is georeferenced, else the mean plane.
  WorldZ,     ///< The world's z axis: right where it was aligned to gravity.
  MeanPlane,  ///< The normal of the plane through the points, on the cameras' side.
};

/// ground_from_world: a rotation about the world's origin after which z is up. Where the reconstruction is georeferenced it also
/// turns x, y to the axes of the map grid (UTM). Throws InputError where the points do not determine a plane and one is asked
/// for.
Pose ground_from_world(const Reconstruction& reconstruction, UpDirection up = UpDirection::Automatic);

/// A placed image that looks at the ground. Queries are const and safe in parallel.
class GroundView {
 public:
  GroundView(std::size_t image, const Camera& camera, const Pose& ground_from_camera);

  std::size_t image() const { return image_; }  ///< Index into Reconstruction::images.
  const Camera& camera() const { return camera_; }
  const Pose& ground_from_camera() const { return ground_from_camera_; }
  const Eigen::Vector3d& centre() const { return ground_from_camera_.translation; }

  /// Pixel of a point (ground frame) where the image shows it: in front, inside the lens's field of view and inside the image.
  std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& x_in_ground) const;

  /// Pixel of a point, also outside the image, as long as it is in front and the lens's model can be trusted there.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_ground) const;

  /// How well the image shows a ground point, in [0, 1]: seen from above rather than aslant, from near rather than from far,
  /// and not at the image's border, where lenses are worst and seams end. `pixel` is its pixel, `height` the usual height of
  /// cameras above the ground.
  double quality(const Eigen::Vector3d& x_in_ground, const Eigen::Vector2d& pixel, double height) const;

 private:
  std::size_t image_;
  Camera camera_;
  Pose ground_from_camera_;
  Pose camera_from_ground_;
  double max_slope_;  ///< Largest distance from the axis at depth 1 within the image.
};

/// The views of all images, in their order.
std::vector<GroundView> ground_views(const Reconstruction& reconstruction, const Pose& ground_from_world);

}  // namespace fabloop
