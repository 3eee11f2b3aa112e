// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/geometry/readout_motion.h"

namespace fabloop {

/// A camera that a bundle places.
struct BundleView {
  Pose world_from_camera;
  bool is_fixed = false;  ///< Its pose stays: it holds the others in place.
  /// Where the camera is by another instrument (GPS), in the world, and its standard deviation along each axis.
  std::optional<Eigen::Vector3d> known_position;
  Eigen::Vector3d position_sigma = Eigen::Vector3d::Ones();
  ReadoutMotion readout{};  ///< Taken as known; zero for a global shutter.
};

/// Where a view sees a point.
struct BundleSighting {
  std::size_t view = 0;
  std::size_t point = 0;
  Eigen::Vector2d pixel;  ///< As detected.
};

/// Views of one camera, the points that they see, and where they see them.
struct Bundle {
  Camera camera;
  std::vector<BundleView> views;
  std::vector<Eigen::Vector3d> points_in_world;
  std::vector<BundleSighting> sightings;
  double pixel_size = 1.0;  ///< As in Features: errors are in pixels of the images in which the sightings were found.
};

/// Which of the camera's numbers are adjusted, too.
enum class RefineCamera {
  Nothing,      ///< A calibration is better than what one flight shows.
  Focal,        ///< fx and fy by one factor.
  FocalRadial,  ///< And k1, k2 of the Radtan model. A flight at one height over flat ground hardly shows them.
};

/// Throws InputError for a camera that RefineCamera knows nothing of: all but the Radtan model.
void require_refinable(const Camera& camera);

struct BundleOptions {
  RefineCamera refine = RefineCamera::Nothing;
  /// Residuals beyond this lose their say (Cauchy). Raise it for rough features.
  double loss_px = 1.5;
  int max_iterations = 30;
  double cost_tolerance = 1e-5;  ///< Stop when the cost falls by a smaller share.
};

/// A bundle after adjustment.
struct AdjustedBundle {
  Camera camera;
  std::vector<Pose> world_from_cameras;
  std::vector<Eigen::Vector3d> points_in_world;
  double initial_cost = 0;  ///< Half the sum of the robust squared errors, px^2.
  double final_cost = 0;
  int iterations = 0;
};

/// Moves views and points (and the camera's numbers when asked to) so that the points are seen where they were detected
/// (Triggs et al. 2000), points eliminated first (Schur complement). One thread: sums over several would come out differently
/// each time. Where no view is fixed the first is held, and the scale stays where it was by the solver's damping.
AdjustedBundle adjust_bundle(const Bundle& bundle, const BundleOptions& options = {});

/// Distance in pixels between where a view sees a point and where it should; infinite behind the camera.
double reprojection_error_px(const Camera& camera, const Pose& world_from_camera, const Eigen::Vector3d& x_in_world,
                             const Eigen::Vector2d& pixel);

}  // namespace fabloop
