// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Keypoints of an image at the threshold nearest to the options' own that gives a number within options.adaptive, which must be
/// set; at its lowest threshold where the texture is too poor for that. Where no threshold gives such a number (they are whole
/// grey levels, or responses are equal) there are too many, and the even selection has to choose. Depends on nothing but the
/// image and the options.
///
/// Where a detector's response is what its threshold is about, the image is looked at once, at the lowest threshold, and the
/// weak are cut off; else (ORB, whose response is Harris' and whose threshold is FAST's; AGAST, whose suppression joins what
/// touches; FAST without suppression) the threshold is bisected on a logarithmic scale.
std::vector<cv::KeyPoint> detect_adaptively(const cv::Mat& image, const FeatureOptions& options);

}  // namespace fabloop
