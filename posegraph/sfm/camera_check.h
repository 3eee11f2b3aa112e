// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/sfm/bundle_adjustment.h"
#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {

struct CameraCheckOptions {
  double probe = 0.03;               ///< The focal length is moved by this share to see what the images say to it.
  double max_relative_sigma = 0.01;  ///< A focal length less certain than this is not taken: it would dome the ground.
  /// Neighbouring errors are alike, so that the sightings say less than their number: their information is divided by this.
  double redundancy = 100.0;
  double max_mismatch = 0.05;  ///< A focal length that differs by more from what the images say is called wrong.
  int num_threads = 0;         ///< 0: all. The result does not depend on it.
  SegmentAdjustmentOptions adjustment{.bundle = {.max_iterations = 12}, .num_points_per_view = 150};
};

/// What the images say to the camera's focal length.
struct CameraCheck {
  double best_focal_factor = 1;  ///< Focal length with which the images agree best, over the given one.
  double relative_sigma = 0;     ///< Its standard deviation as a share; large where height and focal length trade places.
  bool is_determined = false;    ///< The sigma is small enough to trust it.
  bool is_contradicted = false;  ///< The given focal length is wrong beyond doubt.
};

/// Adjusts copies of a segment with the focal length as given, longer and shorter, everything else free: how the least cost rises
/// with it (its profile likelihood, a parabola through three points) tells the best value and its uncertainty. Flights at one
/// height over flat ground hardly show it, and then a free focal length bends the ground into a dome (James & Robson 2014).
CameraCheck check_camera(const Scene& scene, const Segment& segment, const CameraCheckOptions& options = {});

}  // namespace fabloop
