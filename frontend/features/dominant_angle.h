// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fabloop {

/// The dominant direction of the gradients around a point of an image (CV_8UC1, slightly blurred): degrees in [0, 360),
/// clockwise in the image, as OpenCV's keypoints have it. The highest peak of Lowe's histogram (Lowe 2004, section 5) for a
/// blob of diameter `size`; 0 where there are no gradients.
float dominant_angle(const cv::Mat& blurred, const cv::Point2f& centre, float size);

}  // namespace fabloop
