// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// A detector with its descriptor.
enum class FeatureKind {
  Sift,   ///< 128 floats (Lowe 2004).
  Orb,    ///< 32 bytes of bits (Rublee et al. 2011).
  Akaze,  ///< 61 bytes of bits (Alcantarilla et al. 2013).
};

/// What was detected in one image: N keypoints and their descriptors.
struct Features {
  FeatureKind kind = FeatureKind::Sift;
  std::vector<cv::KeyPoint> keypoints;  ///< N, pixel centres at integers, the strongest first.
  cv::Mat descriptors;                  ///< N x D, CV_32F for SIFT, CV_8U (packed bits) for ORB and AKAZE.
};

}  // namespace fabloop
