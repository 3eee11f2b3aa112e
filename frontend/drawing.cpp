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

void dashed_polyline(cv::Mat& picture, const std::vector<cv::Point2d>& points, const std::vector<double>& dashes_px,
                     const cv::Scalar& colour, int thickness_px) {
  if (dashes_px.empty()) {
    polyline(picture, points, colour, thickness_px);
    return;
  }
  std::size_t dash = 0;
  double left = dashes_px.front();
  std::vector<cv::Point2d> stroke;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double length = cv::norm(points[i + 1] - points[i]);
    const auto at = [&](double along) { return points[i] + (along / length) * (points[i + 1] - points[i]); };
    for (double along = 0.0; along < length;) {
      const bool is_drawn = dash % 2 == 0, ends_here = along + left <= length;
      const double next = ends_here ? along + left : length;
      if (is_drawn && stroke.empty()) stroke.push_back(at(along));
      if (is_drawn) stroke.push_back(at(next));
      if (!ends_here) left -= next - along;
      along = next;
      if (!ends_here) break;
      if (is_drawn) polyline(picture, stroke, colour, thickness_px);
      stroke.clear();
      left = dashes_px[++dash % dashes_px.size()];
    }
  }
  polyline(picture, stroke, colour, thickness_px);
}

void circle(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour, int thickness_px) {
  cv::circle(picture, fixed(centre), fixed(radius_px), colour, thickness_px, cv::LINE_AA, kFractionBits);
}

void disc(cv::Mat& picture, const cv::Point2d& centre, double radius_px, const cv::Scalar& colour) {
  circle(picture, centre, radius_px, colour, cv::FILLED);
}

}  // namespace fabloop::draw
