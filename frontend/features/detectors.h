// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// OpenCV's SIFT, ORB, BRISK, AKAZE, KAZE, FAST or AGAST as the options and the threshold have it; null for the others. These
/// hold scratch memory, so every call makes its own: that is cheap, and calls may run in parallel.
cv::Ptr<cv::Feature2D> make_opencv_detector(const FeatureOptions& options, double threshold);

/// Side of the smallest image in which a detector looks for anything: below it OpenCV's filters do not fit.
int least_image_side(DetectorKind kind);

/// Keypoints of an 8-bit grey image whose response is at least `threshold`, in no order. None for tiny images.
std::vector<cv::KeyPoint> detect(const cv::Mat& image, const FeatureOptions& options, double threshold);

/// BRISK samples a circle 2.55 of its keypoint's sizes across (18.4 pixels at size 7.2), and descriptors look at six spots.
inline constexpr double kSpotPerBriskSize = 18.4 / 7.2 / 6.0;

/// The diameter of the spot that a detector found, from a keypoint's size, which ORB and BRISK give as that of their own
/// descriptor's patch.
float spot_size(DetectorKind kind, const cv::KeyPoint& keypoint);

}  // namespace fabloop
