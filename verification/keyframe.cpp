// SPDX-License-Identifier: BSD-3-Clause
#include "verification/keyframe.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

/// What six printed digits leave of a quaternion's length, with room.
constexpr double kMaxQuaternionNormError = 1e-3;
/// A host's point lies within pixels of its feature: far less than this for any lens.
constexpr double kMaxRayErrorDeg = 3.0;

[[noreturn]] void fail(const Keyframe& keyframe, const std::string& what) {
  throw InputError("keyframe " + std::to_string(keyframe.frame) + ": " + what);
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

void validate_pose(const Keyframe& keyframe) {
  const Pose& pose = keyframe.odom_from_body;
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
    fail(keyframe, "odom_from_body has a number that is not finite; hand over keyframes only where the odometry has a pose");
  }
  if (std::abs(pose.rotation.norm() - 1.0) > kMaxQuaternionNormError) {
    fail(keyframe, "the quaternion of odom_from_body is not of unit length; normalise it");
  }
  if (keyframe.step_covariance && !is_covariance(*keyframe.step_covariance)) {
    fail(keyframe,
         "step_covariance is not symmetric positive semidefinite; give the covariance of (translation, rotation), not the "
         "information, or leave it out");
  }
}

void validate_size(const Keyframe& keyframe, const cv::Mat& image, const Camera& camera, const std::string& name) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  fail(keyframe, "the " + name + " is " + size_text(image.cols, image.rows) + " and the camera " +
                     size_text(camera.width, camera.height) + " pixels; resize the " + name + " or use scaled(camera, factor)");
}

void validate_image(const Keyframe& keyframe, const Camera& camera) {
  if (keyframe.image.empty() == !keyframe.features) {
    fail(keyframe, keyframe.features ? "has an image and features; give one of them" : "has neither an image nor features");
  }
  if (keyframe.image.empty()) return;
  if (keyframe.image.type() != CV_8UC1) fail(keyframe, "the image is not 8-bit grey (CV_8UC1); convert it");
  validate_size(keyframe, keyframe.image, camera, "image");
}

void validate_features(const Keyframe& keyframe, DescriptorKind kind) {
  const Features& features = *keyframe.features;
  if (features.descriptor_kind != kind) {
    fail(keyframe, "the model knows " + std::string(to_string(kind)) + " descriptors, these are " +
                       std::string(to_string(features.descriptor_kind)) + "; extract with the model's options");
  }
  if (!features.descriptors.empty() && features.descriptors.type() != descriptor_layout(kind).cv_type) {
    fail(keyframe, std::string(to_string(kind)) + " descriptors are " +
                       (descriptor_layout(kind).cv_type == CV_32F ? "32-bit floats" : "packed bits") +
                       ", one row a feature; these are something else");
  }
  if (features.descriptors.rows != static_cast<int>(features.keypoints.size())) {
    fail(keyframe, "has " + std::to_string(features.keypoints.size()) + " keypoints and " +
                       std::to_string(features.descriptors.rows) + " descriptors; give one descriptor a keypoint");
  }
  if (!(std::isfinite(features.pixel_size) && features.pixel_size > 0)) {
    fail(keyframe, "its features' pixel size is not positive; 1 where they were found in the image as it is");
  }
  for (const cv::KeyPoint& keypoint : features.keypoints) {
    if (!std::isfinite(keypoint.pt.x) || !std::isfinite(keypoint.pt.y)) {
      fail(keyframe, "a keypoint's pixel is not finite; leave such features out");
    }
  }
}

void validate_points(const Keyframe& keyframe) {
  if (keyframe.points_in_camera.empty()) return;
  if (!keyframe.depth.empty()) fail(keyframe, "has points and a depth image; give one of them");
  if (!keyframe.features) {
    fail(keyframe, "has points and no features that they could belong to; give the features, or a depth image");
  }
  if (keyframe.points_in_camera.size() != keyframe.features->keypoints.size()) {
    fail(keyframe, "has " + std::to_string(keyframe.points_in_camera.size()) + " points and " +
                       std::to_string(keyframe.features->keypoints.size()) +
                       " features; give one entry a feature, empty where the point is unknown");
  }
  for (const auto& point : keyframe.points_in_camera) {
    if (point && (!point->allFinite() || point->norm() == 0.0)) {
      fail(keyframe, "a point is not finite or is the camera's own centre; leave the entry empty where the point is unknown");
    }
  }
}

void validate_depth(const Keyframe& keyframe, const Camera& camera) {
  if (keyframe.depth.empty()) return;
  const int type = keyframe.depth.type();
  if (type != CV_32FC1 && type != CV_16UC1) {
    fail(keyframe, "the depth image is neither CV_32FC1 (metres) nor CV_16UC1 (units); convert it");
  }
  validate_size(keyframe, keyframe.depth, camera, "depth image");
  if (type == CV_16UC1 && !(std::isfinite(keyframe.depth_unit_m) && keyframe.depth_unit_m > 0.0)) {
    fail(keyframe, "depth_unit_m must be positive: the metres of one unit of the 16-bit depth image");
  }
}

void validate_height(const Keyframe& keyframe) {
  const auto& height = keyframe.height_above_ground;
  if (height && !(std::isfinite(*height) && *height > 0.0)) {
    fail(keyframe, "its height above ground must be positive; leave it empty where it is unknown");
  }
}

/// Depth [m] at the pixel next to the keypoint; none where the image does not know it.
std::optional<double> depth_at(const Keyframe& keyframe, const cv::Point2f& pixel) {
  const cv::Mat& depth = keyframe.depth;
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x)), 0, depth.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y)), 0, depth.rows - 1);
  const double value = depth.type() == CV_16UC1 ? keyframe.depth_unit_m * depth.at<std::uint16_t>(y, x)
                                                : static_cast<double>(depth.at<float>(y, x));
  if (!std::isfinite(value) || value <= 0.0) return std::nullopt;
  return value;
}

std::vector<std::optional<Eigen::Vector3d>> points_by_depth(const Keyframe& keyframe, const View& view) {
  std::vector<std::optional<Eigen::Vector3d>> points(view.rays.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto depth = depth_at(keyframe, view.features.keypoints[i].pt);
    if (depth && view.rays[i].z() > 0.0) points[i] = *depth / view.rays[i].z() * view.rays[i];
  }
  return points;
}

/// Points in another frame (the world, the body) lie anywhere but on the rays of their features.
void require_on_rays(const Keyframe& keyframe, const View& view) {
  std::size_t num_points = 0, num_off = 0;
  for (std::size_t i = 0; i < view.rays.size(); ++i) {
    if (!keyframe.points_in_camera[i]) continue;
    ++num_points;
    num_off += deg_from_rad(angle_between(*keyframe.points_in_camera[i], view.rays[i])) > kMaxRayErrorDeg;
  }
  if (2 * num_off > num_points) {
    fail(keyframe, std::to_string(num_off) + " of " + std::to_string(num_points) +
                       " points do not lie on the rays of their features; give them in the camera's frame (x right, y down, z "
                       "forward) and in the features' order");
  }
}

}  // namespace

void validate(const Keyframe& keyframe, const Camera& camera, DescriptorKind descriptor_kind) {
  validate_pose(keyframe);
  validate_image(keyframe, camera);
  if (keyframe.features) validate_features(keyframe, descriptor_kind);
  validate_points(keyframe);
  validate_depth(keyframe, camera);
  validate_height(keyframe);
}

void require_follows(const Keyframe& keyframe, std::size_t last_frame, std::int64_t last_time_ns) {
  if (keyframe.frame <= last_frame) {
    fail(keyframe, "comes after keyframe " + std::to_string(last_frame) + "; number keyframes in ascending order");
  }
  if (keyframe.time_ns < last_time_ns) {
    fail(keyframe, "its stamp of " + std::to_string(keyframe.time_ns) + " ns lies before the last one's " +
                       std::to_string(last_time_ns) + " ns; hand keyframes over in order of time");
  }
}

View view_of(const Keyframe& keyframe, const Camera& camera, Features features, double point_sigma) {
  View view = make_view(keyframe.frame, camera, std::move(features));
  view.height_above_ground = keyframe.height_above_ground;
  if (keyframe.points_in_camera.empty() && keyframe.depth.empty()) return view;
  if (!keyframe.points_in_camera.empty()) require_on_rays(keyframe, view);
  const auto points = keyframe.depth.empty() ? keyframe.points_in_camera : points_by_depth(keyframe, view);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i]) set_known_point(view, i, *points[i], point_sigma);
  }
  return view;
}

}  // namespace fabloop
