// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/features/features.h"

namespace fabloop {

struct FeaturePictureOptions {
  int longer_side_px = 1200;  ///< Images are scaled to it: small ones up, so that circles can be told apart.
};

/// A picture (BGR) of what was detected: every keypoint a circle as large as its spot, coloured by its size, with its direction
/// where it has one. Below the image a line of text: `title`, and the sizes that the colours mean.
cv::Mat draw_features(const cv::Mat& gray, const FeatureKind& kind, const std::vector<cv::KeyPoint>& keypoints,
                      const std::string& title, const FeaturePictureOptions& options = {});

/// Pictures side by side, row by row, on white; all are scaled to one width.
cv::Mat montage(const std::vector<cv::Mat>& pictures, int columns, int picture_width_px);

}  // namespace fabloop
