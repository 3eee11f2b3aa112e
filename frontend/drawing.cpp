// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/drawing.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fabloop::draw {
namespace {

/// OpenCV draws at fractions of a pixel in fixed-point numbers with so many bits behind the point.
constexpr int kFractionBits = 4;

int fixed(double px) { return static_cast<int>(std::lround(px * (1 << kFractionBits))); }

cv::Point fixed(const cv::Point2d& point) { return {fixed(point.x), fixed(point.y)}; }

}  // namespace

void line(cv::Mat& picture, const cv::Point2d& begin, const cv::Point2d& end, const cv::Scalar& colour, int thickness_px) {
  cv::line(picture, fixed(begin), fixed(end), colour, thickness_px, cv::LINE_AA, kFractionBits);
}

void polyline(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour, int thickness_px) {
  std::vector<cv::Point> fixed_points;
  for (const cv::Point2d& point : points) fixed_points.push_back(fixed(point));
  cv::polylines(picture, fixed_points, false, colour, thickness_px, cv::LINE_AA, kFractionBits);
}

void circle(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour, int thickness_px) {
  cv::circle(picture, fixed(centre), fixed(radius_px), colour, thickness_px, cv::LINE_AA, kFractionBits);
}

void disc(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour) {
  circle(picture, centre, radius_px, colour, cv::FILLED);
}

}  // namespace fabloop::draw
