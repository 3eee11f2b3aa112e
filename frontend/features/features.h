// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/feature_kind.h"

namespace fabloop {

/// What was detected in one image: N keypoints and their descriptors.
struct Features {
  DescriptorKind descriptor_kind = DescriptorKind::Sift;
  /// N, pixel centres at integers, in the order of spatially_even(): the first n cover the image evenly, for any n. `size` is the
  /// diameter in pixels of the spot that was detected, and a descriptor looks at about six of it, whatever the detector; `angle`
  /// is in degrees, clockwise in the image as in OpenCV, and -1 where no direction was needed.
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;  ///< N x D, CV_32F or CV_8U (packed bits): see descriptor_layout(). All finite.
  /// Side of a pixel of the image in which they were found, in pixels of the keypoints: more than 1 where that image was shrunk.
  /// How far features may lie off, or apart, is said in pixels of the image in which they were found.
  double pixel_size = 1.0;
};

}  // namespace fabloop
