// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// SURF (Bay et al., CVIU 2008) by whichever library was there when fabloop was built: OpenCV's xfeatures2d with its non-free
/// part ("opencv"), else dlib ("dlib"), else none (""). Their descriptors have one layout but are not equal: a vocabulary
/// belongs to the library that it was trained with.
std::string_view surf_library();

/// Throws InputError that says how to get SURF when it was not built in.
void require_surf();

/// Blobs of an 8-bit grey image whose determinant of the Hessian is at least `threshold`. Sizes are the package's, the diameter
/// of the blob (OpenCV's own SURF gives the width of its filter, 2.25 times as much); angles are not set.
std::vector<cv::KeyPoint> detect_surf(const cv::Mat& gray, const SurfOptions& options, double threshold);

/// Describes keypoints, in their order: N x 64, CV_32F, each row of unit length, or zero where the image is flat. The window of
/// 20 s is six times the keypoint's size wide, so s = 0.3 size; beyond the image its border continues. Keypoints without an
/// angle get their dominant one, or 0 under `Upright`.
cv::Mat describe_surf(const cv::Mat& gray, std::vector<cv::KeyPoint>& keypoints, Orientation orientation);

}  // namespace fabloop
