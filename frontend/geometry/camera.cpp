// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "frontend/error.h"

namespace fabloop {
namespace {

cv::Matx33d camera_matrix(const Camera& camera) { return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}; }

/// OpenCV's plumb-bob and rational polynomial model (OpenCV documentation, "Camera Calibration and 3D Reconstruction").
Eigen::Vector2d distort_radtan(const std::vector<double>& coefficients, double x, double y) {
  const auto k = [&](std::size_t i) { return i < coefficients.size() ? coefficients[i] : 0.0; };
  const double r2 = x * x + y * y;
  const double radial = (1 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
  return {x * radial + 2 * k(2) * x * y + k(3) * (r2 + 2 * x * x), y * radial + k(2) * (r2 + 2 * y * y) + 2 * k(3) * x * y};
}

/// Kannala and Brandt 2006, as OpenCV's fisheye module writes it.
Eigen::Vector2d distort_equidistant(const std::vector<double>& coefficients, double x, double y) {
  const auto k = [&](std::size_t i) { return i < coefficients.size() ? coefficients[i] : 0.0; };
  const double r = std::hypot(x, y);
  if (r < 1e-12) return {x, y};
  const double theta = std::atan(r);
  const double t2 = theta * theta;
  const double theta_d = theta * (1 + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3)))));
  return {x * theta_d / r, y * theta_d / r};
}

}  // namespace

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  if (!(x_in_camera.z() > 1e-9)) return std::nullopt;
  const double x = x_in_camera.x() / x_in_camera.z();
  const double y = x_in_camera.y() / x_in_camera.z();
  const Eigen::Vector2d distorted = camera.distortion_model == DistortionModel::Equidistant
                                        ? distort_equidistant(camera.distortion, x, y)
                                        : distort_radtan(camera.distortion, x, y);
  return Eigen::Vector2d(camera.fx * distorted.x() + camera.cx, camera.fy * distorted.y() + camera.cy);
}

std::vector<Eigen::Vector3d> bearings(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<Eigen::Vector3d> rays;
  if (pixels.empty()) return rays;
  std::vector<cv::Point2d> distorted, normalised;
  distorted.reserve(pixels.size());
  for (const auto& pixel : pixels) distorted.emplace_back(pixel.x(), pixel.y());
  if (camera.distortion_model == DistortionModel::Equidistant && !camera.distortion.empty()) {
    cv::fisheye::undistortPoints(distorted, normalised, camera_matrix(camera), camera.distortion);
  } else {
    const cv::TermCriteria until_exact(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-10);
    cv::undistortPoints(distorted, normalised, camera_matrix(camera), camera.distortion, cv::noArray(), cv::noArray(),
                        until_exact);
  }
  rays.reserve(pixels.size());
  for (const auto& point : normalised) rays.push_back(Eigen::Vector3d(point.x, point.y, 1.0).normalized());
  return rays;
}

Camera scaled(const Camera& camera, double factor) {
  Camera result = camera;
  result.width = static_cast<int>(std::lround(camera.width * factor));
  result.height = static_cast<int>(std::lround(camera.height * factor));
  result.fx *= factor;
  result.fy *= factor;
  // Pixel centres lie at integers, so the image's corner is at -0.5.
  result.cx = (camera.cx + 0.5) * factor - 0.5;
  result.cy = (camera.cy + 0.5) * factor - 0.5;
  return result;
}

void validate(const Camera& camera, const std::string& where) {
  const auto fail = [&](const std::string& what) { throw InputError(where + ": " + what); };
  if (camera.width <= 0 || camera.height <= 0) fail("the image size is missing or not positive");
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
    if (!std::isfinite(value)) fail("the camera matrix has a number that is not finite");
  }
  if (camera.fx <= 0 || camera.fy <= 0) fail("the focal length is not positive; is the camera matrix filled in?");
  if (camera.cx < 0 || camera.cx > camera.width || camera.cy < 0 || camera.cy > camera.height) {
    fail("the principal point lies outside the image; were image_width and image_height swapped, or the image resized?");
  }
  if (!std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return std::isfinite(k); })) {
    fail("a distortion coefficient is not finite");
  }
  const std::size_t count = camera.distortion.size();
  const bool fits = camera.distortion_model == DistortionModel::Equidistant
                        ? (count == 0 || count == 4)
                        : (count == 0 || count == 4 || count == 5 || count == 8);
  if (!fits) fail("the number of distortion coefficients (" + std::to_string(count) + ") does not fit the distortion model");
}

}  // namespace fabloop
