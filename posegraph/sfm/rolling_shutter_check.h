// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/segment.h"

namespace fabloop {

struct RollingShutterCheckOptions {
  double loss_px = 1.5;  ///< As of the adjustment that the segment comes from.
  /// How well a calibration is known, as shares of the focal length. Its errors are estimated beside the readout time and held by
  /// these alone: a rolling shutter looks like one or the other where all cameras fly alike in their own frames, and is told no
  /// better there than the calibration is known. Lower them for a camera from a test field.
  double affine_sigma = 1e-3;  ///< Ratio of fx and fy; skew.
  double focal_sigma = 1e-2;
  double principal_point_sigma = 1e-2;  ///< Each axis; often it is taken for the image's centre.
  double radial_sigma = 1e-2;           ///< k1.
  double decentring_sigma = 1e-3;       ///< p1 and p2.
  double min_shift_px = 1.0;            ///< From the first row to the last, in pixels of the images; less is not worth a warning.
};

/// Beyond so many sigmas something is called certain.
inline constexpr double kCertainSigmas = 4.0;

/// What the images say to the time between a camera's first row and its last.
struct RollingShutterCheck {
  bool is_known = false;  ///< Cameras move, there are enough of them, and no single one decides alone.
  double readout_s = 0;   ///< Best value; negative where rows are read from the last to the first.
  double sigma_s = 0;     ///< Its standard deviation.
  /// Best value where the calibration is taken as exact, as the map takes them: what an adjustment is best made under.
  double readout_of_given_camera_s = 0;
  double px_per_s = 0;       ///< How far the median sighting moves over the image in a second, pixels of the images.
  bool is_certain = false;   ///< The best value is beyond doubt not zero.
  bool is_relevant = false;  ///< It is, and moves sightings by more than `min_shift_px`.

  double shift_px() const { return readout_s * px_per_s; }
  double shift_sigma_px() const { return sigma_s * px_per_s; }
};

/// One Gauss-Newton step of the readout time from an adjusted segment, poses, points and calibration free beside it. The sigma is
/// robust against errors that are alike within an image, and holds for few images: it is the jackknife's, by how far the step
/// goes astray without each image in turn (Bell & McCaffrey 2002; the README has the equations).
/// Nothing is known from fewer than 18 images, twice the unknowns: what their scores scatter by would be too little of the noise.
/// `readout_s` is the one under which the segment was adjusted, 0 where it has no readout_motions; rates are one a view.
RollingShutterCheck check_rolling_shutter(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
                                          double readout_s, const RollingShutterCheckOptions& options = {});

/// Sets what follows from the best value and its sigma: `is_certain`, `is_relevant`.
void judge(RollingShutterCheck& check, const RollingShutterCheckOptions& options = {});

}  // namespace fabloop
