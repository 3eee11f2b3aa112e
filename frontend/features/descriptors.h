// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_options.h"
#include "frontend/features/features.h"

namespace fabloop {

/// Removes keypoints of another detector that lie too near the image's edge for ORB's and BRISK's patterns, so that they are not
/// chosen and then lost.
void erase_undescribable(std::vector<cv::KeyPoint>& keypoints, const cv::Size& image, const FeatureOptions& options);

/// Describes keypoints that detect() found in the same image, in their order; those too near the image's edge for the descriptor
/// are missing. Keypoints without an angle get one where the descriptor needs it.
Features describe(const cv::Mat& image, std::vector<cv::KeyPoint> keypoints, const FeatureOptions& options);

}  // namespace fabloop
