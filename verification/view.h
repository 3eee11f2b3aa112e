// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/fabmap/observation.h"
#include "frontend/features/features.h"
#include "frontend/geometry/camera.h"

namespace fabloop {

/// One image as geometry sees it: N features, the ray of each, and the point it shows where its depth is known.
struct View {
  std::size_t frame = 0;  ///< Position in its sequence.
  Camera camera;
  Features features;                                             ///< N.
  std::vector<Eigen::Vector3d> rays;                             ///< N, unit, camera frame.
  std::vector<std::optional<Eigen::Vector3d>> points_in_camera;  ///< N, in the odometry's unit of length.
  /// The camera's height above the ground along the ground's normal, in the odometry's unit of length: a scale where the ground
  /// is a plane (see plane_scale.h).
  std::optional<double> height_above_ground{};
  std::vector<double> point_weights;  ///< N, of the points as measured so far; see add_point_measurement().
  double unit_sigma = 0;        ///< Relative, of the points' common unit of length, where it is known less well than a step's.
  std::vector<WordId> words{};  ///< N, the word of each feature; empty where nobody asks for them (see MatchBy).
};

/// A view without points.
View make_view(std::size_t frame, const Camera& camera, Features features);

/// The focal length in pixels of the image in which the view's features were found: what turns an error of theirs into an angle.
double feature_focal_px(const View& view);

/// Gives feature i of a view another measurement of its point, seen under a parallax of `parallax_rad`. Points seen before
/// become the mean weighed by squared parallax; when the two depths differ by more than their parallaxes allow, the feature
/// loses its point until it is measured again.
void add_point_measurement(View& view, std::size_t i, const Eigen::Vector3d& x_in_camera, double parallax_rad);

/// Gives feature i of a view a point that somebody else measured (a depth camera, a host's map), known to `relative_sigma` of
/// its depth. It weighs as a triangulated point of that accuracy.
void set_known_point(View& view, std::size_t i, const Eigen::Vector3d& x_in_camera, double relative_sigma);

/// Forgets all points.
void clear_points(View& view);

/// Number of features whose depth is known.
std::size_t count_points(const View& view);

}  // namespace fabloop
