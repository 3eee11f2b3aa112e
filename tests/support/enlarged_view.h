// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "verification/view.h"

namespace fabloop::testing_support {

/// Features as an image `times` as large gives them when it is shrunk to this one's size.
inline Features enlarged(Features features, double times) {
  for (cv::KeyPoint& keypoint : features.keypoints) {
    const cv::Point2d pixel = times * (cv::Point2d(keypoint.pt) + cv::Point2d(0.5, 0.5)) - cv::Point2d(0.5, 0.5);
    keypoint.pt = pixel;
    keypoint.size *= static_cast<float>(times);
  }
  features.pixel_size *= times;
  return features;
}

/// The view of such an image, with the points that are known.
inline View enlarged(const View& view, double times) {
  View large = view;
  View seen = make_view(view.frame, scaled(view.camera, times), enlarged(view.features, times));
  large.camera = std::move(seen.camera);
  large.features = std::move(seen.features);
  large.rays = std::move(seen.rays);
  return large;
}

}  // namespace fabloop::testing_support
