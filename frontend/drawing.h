// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// Antialiased strokes at fractions of a pixel on a picture (BGR, 8 bit); whole coordinates are pixel centres. What lies outside
/// the picture is cut off.
namespace draw {

void line(cv::Mat& picture, const cv::Point2d& begin, const cv::Point2d& end, const cv::Scalar& colour, int thickness_px = 1);

/// Open: the last point is not joined to the first.
void polyline(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour, int thickness_px = 1);

/// As polyline(), with dashes: lengths in pixels that are drawn and left out by turns, along the whole path. Empty: all is drawn.
void dashed_polyline(cv::Mat& picture, const std::vector<cv::Point2d>& points, const std::vector<double>& dashes_px,
                     const cv::Scalar& colour, int thickness_px = 1);

void circle(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour, int thickness_px = 1);

/// A filled circle.
void disc(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour);

}  // namespace draw
}  // namespace fabloop
