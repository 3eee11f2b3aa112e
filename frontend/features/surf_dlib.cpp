// SPDX-License-Identifier: BSD-3-Clause
#include <dlib/image_keypoint/surf.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "frontend/features/surf.h"

namespace fabloop {
namespace {

/// The image with its border continued, in which dlib's templates look up sums of boxes.
class BoxSums {
 public:
  BoxSums(const cv::Mat& gray, int padding) {
    cv::Mat padded;
    cv::copyMakeBorder(gray, padded, padding, padding, padding, padding, cv::BORDER_REPLICATE);
    cv::integral(padded, sums_, CV_64F);  // exact: integers below 2^53
  }

  // What dlib asks an integral image for.
  using value_type = double;
  long nr() const { return sums_.rows - 1; }
  long nc() const { return sums_.cols - 1; }
  double get_sum_of_area(const dlib::rectangle& area) const {
    const double* above = sums_.ptr<double>(static_cast<int>(area.top()));
    const double* below = sums_.ptr<double>(static_cast<int>(area.bottom()) + 1);
    return below[area.right() + 1] - below[area.left()] - above[area.right() + 1] + above[area.left()];
  }

 private:
  cv::Mat1d sums_;
};

/// OpenCV divides each box of a second derivative by its own area, dlib all of them by the whole filter's, which is 5.4 times
/// as much for the smallest filter and 4.5 times for large ones. The determinant has it squared.
constexpr double kOpenCvFromDlib = 5.0 * 5.0;

constexpr double kScalePerSize = 0.3;

/// dlib samples every second pixel in the first octave, as Bay et al. do.
constexpr long kStep = 2;

/// Reach of a descriptor from its centre, in scales: the corner of its rotated square, and half a Haar filter more.
constexpr double kDlibReach = 15.5;

constexpr double kDegreesPerRadian = 180.0 / CV_PI;

/// Below it no second derivative fits: the filters of the first octave reach so far.
constexpr int kDlibLeastSide = 32;

bool is_finite(const dlib::interest_point& point) {
  return std::isfinite(point.center.x()) && std::isfinite(point.center.y()) && std::isfinite(point.scale) && point.scale > 0;
}

}  // namespace

std::string_view surf_library() { return "dlib"; }

void require_surf() {}

std::vector<cv::KeyPoint> detect_surf(const cv::Mat& gray, const SurfOptions& options, double threshold) {
  if (std::min(gray.rows, gray.cols) < kDlibLeastSide) return {};
  const BoxSums sums(gray, 0);
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(sums, options.num_octaves, options.layers_per_octave + 2, kStep);
  std::vector<dlib::interest_point> points;
  // A flat image has a determinant of zero everywhere, which is no maximum.
  constexpr double kLeastThreshold = 1e-6;
  dlib::get_interest_points(pyramid, std::max(threshold / kOpenCvFromDlib, kLeastThreshold), points);
  std::vector<cv::KeyPoint> keypoints;
  for (const dlib::interest_point& point : points) {
    if (!is_finite(point)) continue;
    const auto size = static_cast<float>(point.scale / kScalePerSize);
    const auto response = static_cast<float>(point.score * kOpenCvFromDlib);
    keypoints.emplace_back(static_cast<float>(point.center.x()), static_cast<float>(point.center.y()), size, -1.0F, response);
  }
  return keypoints;
}

cv::Mat describe_surf(const cv::Mat& gray, std::vector<cv::KeyPoint>& keypoints, Orientation orientation) {
  cv::Mat descriptors(static_cast<int>(keypoints.size()), 64, CV_32F);
  if (keypoints.empty()) return descriptors;
  double largest = 0;
  for (const cv::KeyPoint& keypoint : keypoints) largest = std::max<double>(largest, keypoint.size);
  const int padding = static_cast<int>(std::ceil(kDlibReach * std::max(1.0, kScalePerSize * largest))) + 4;
  const BoxSums sums(gray, padding);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    cv::KeyPoint& keypoint = keypoints[i];
    const dlib::vector<double, 2> centre(double{keypoint.pt.x} + padding, double{keypoint.pt.y} + padding);
    const double scale = std::max(1.0, kScalePerSize * keypoint.size);
    double angle = keypoint.angle / kDegreesPerRadian;
    if (orientation == Orientation::Upright) {
      angle = 0;
    } else if (keypoint.angle < 0) {
      angle = dlib::compute_dominant_angle(sums, centre, scale);
    }
    const double degrees = angle * kDegreesPerRadian;
    keypoint.angle = static_cast<float>(degrees < 0 ? degrees + 360.0 : degrees);
    dlib::matrix<double, 64, 1> descriptor;
    dlib::compute_surf_descriptor(sums, centre, scale, angle, descriptor);
    auto* row = descriptors.ptr<float>(static_cast<int>(i));
    for (int c = 0; c < 64; ++c) row[c] = static_cast<float>(descriptor(c));
  }
  return descriptors;
}

}  // namespace fabloop
