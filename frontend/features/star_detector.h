// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Centre-surround extrema (Agrawal, Konolige and Blas, "CenSurE", ECCV 2008), the detector that OpenCV and openFABMAP call
/// STAR: the response is the mean over an octagon less the mean over the ring around it up to twice its radius. It is computed
/// at full resolution at every scale, so that positions are as precise at large scales as at small ones.
///
/// A keypoint is where the response is an extremum over 3 x 3 positions and 3 scales, is at least `threshold` grey levels
/// strong, and changes in two directions, as does the scale of the strongest response (which lines and edges do not). Its size
/// is the octagon's diameter, interpolated: that of the blob. Takes an 8-bit grey image of any size; ordered by scale, then by
/// place.
std::vector<cv::KeyPoint> detect_star(const cv::Mat& gray, const StarOptions& options, double threshold);

}  // namespace fabloop
