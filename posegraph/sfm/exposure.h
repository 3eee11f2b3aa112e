// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "posegraph/sfm/ground_grid.h"
#include "posegraph/sfm/mosaic_blocks.h"

namespace fabloop {

/// What makes the same ground equally bright in all images: a gain an image and channel, and one radial fall-off a camera and
/// channel.
struct Exposure {
  /// log of the gain, BGR, one a view.
  std::vector<cv::Vec3d> log_gain;
  /// log of what the border loses: a r^2 + b r^4 + c r^6 with r = image_radius(); [camera][channel].
  std::vector<std::array<std::array<double, 3>, 3>> log_falloff;

  /// What a pixel at `radius` of a view is multiplied by.
  cv::Vec3f gain(std::size_t view, std::size_t camera, double radius) const;
};

/// Least squares over all pairs of views that show a block, in logarithms (as Brown & Lowe 2007, eq. 29, with the fall-off
/// as further unknowns), under Huber's loss; gains are held near 1 as far as the pairs do not tell them. `camera_of` has one
/// index a view.
Exposure equalise_exposure(const MosaicBlocks& blocks, const std::vector<std::size_t>& camera_of, std::size_t num_cameras);

/// What a grid's cells are to be multiplied by (BGR) for the ground to be as bright at large as the images show it: one over the
/// geometric mean of the gains about each cell, weighed by a Gaussian of standard deviation `reach` about the places that the
/// views stand above. Gains are found from neighbour to neighbour and drift over many, until what no image shows clipped would
/// be. The factor is of the ground, so that it opens no seams.
cv::Mat3f drift_factors(const Exposure& exposure, const std::vector<Eigen::Vector2d>& places, const GroundGrid& grid,
                        double reach);

}  // namespace fabloop
