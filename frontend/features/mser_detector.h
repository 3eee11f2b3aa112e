// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Maximally stable extremal regions (Matas et al. 2002, by OpenCV) as keypoints: the centroid, the diameter of the circle with
/// the region's second moments, and, as the response, the difference between the region's mean grey level and that of what lies
/// around it in its box grown by half. Those with less than `threshold` are dropped.
std::vector<cv::KeyPoint> detect_mser(const cv::Mat& gray, const MserOptions& options, double threshold);

}  // namespace fabloop
