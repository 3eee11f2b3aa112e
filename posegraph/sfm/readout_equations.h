// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/segment.h"

/// What sightings say to a readout time beside everything else that an adjustment leaves free (private).
namespace fabloop {

/// The unknowns: first the readout time (s), then what a calibration may have wrong, each beside the focal length: the ratio of
/// the axes, the skew, the focal length itself, the principal point (x, y), k1, and decentring (p1, p2).
using ReadoutVector = Eigen::Matrix<double, 9, 1>;
using ReadoutMatrix = Eigen::Matrix<double, 9, 9>;

/// A least-squares problem in the unknowns alone, poses and points eliminated, as the sum of what each image says: its
/// information and its score (the gradient of half the squared errors) at the point where the segment was adjusted.
struct ReadoutEquations {
  std::vector<ReadoutMatrix> information;  ///< One a placed view that sees enough of the points.
  std::vector<ReadoutVector> score;
  double px_per_s = 0;  ///< How far the median sighting moves over the image in a second, pixels of the images.
};

/// Empty where poses and points are not determined. Errors beyond `loss_px` lose their say (Cauchy).
ReadoutEquations readout_equations(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
                                   double loss_px);

}  // namespace fabloop
