// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Keypoints of an image at the threshold nearest to options' own that gives a number within options.adaptive, which must be
/// set; at its lowest threshold where the texture is too poor for that. Depends on nothing but the image and the options.
///
/// Where a detector's response is what its threshold is about, the image is looked at once, at the lowest threshold, and the
/// weak are cut off; else (ORB, whose response is Harris' and whose threshold is FAST's; FAST and AGAST without suppression)
/// the threshold is bisected on a logarithmic scale, and of several tries the one nearest to the wanted number is given.
std::vector<cv::KeyPoint> detect_adaptively(const cv::Mat& image, const FeatureOptions& options);

}  // namespace fabloop
