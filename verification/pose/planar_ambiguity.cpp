// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/planar_ambiguity.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <utility>
#include <vector>

namespace fabloop {
namespace {

/// Rays as image points of a unit pinhole; those of more than a right angle have none and are left out.
struct PlanePoints {
  std::vector<cv::Point2d> query, match;
};

PlanePoints plane_points(std::span<const RayPair> pairs, std::span<const std::size_t> indices) {
  constexpr double kMinDepth = 0.1;
  PlanePoints points;
  for (const std::size_t i : indices) {
    const auto& [query, match] = pairs[i];
    if (query.z() < kMinDepth || match.z() < kMinDepth) continue;
    points.query.emplace_back(query.x() / query.z(), query.y() / query.z());
    points.match.emplace_back(match.x() / match.z(), match.y() / match.z());
  }
  return points;
}

bool differ(const Pose& a, const Pose& b, const PlanarAmbiguityOptions& options) {
  return deg_from_rad(a.rotation.angularDistance(b.rotation)) > options.min_rotation_deg ||
         deg_from_rad(angle_between(a.translation, b.translation)) > options.min_direction_deg;
}

/// The up to four poses of a homography; their translations are unit directions.
std::vector<Pose> poses_of(const cv::Mat& homography) {
  std::vector<cv::Mat> rotations, translations, normals;
  cv::decomposeHomographyMat(homography, cv::Mat::eye(3, 3, CV_64F), rotations, translations, normals);
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    Eigen::Matrix3d rotation;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) rotation(r, c) = rotations[k].at<double>(r, c);
    }
    const auto* const t = translations[k].ptr<double>();
    poses.push_back({Eigen::Quaterniond(rotation).normalized(), Eigen::Vector3d(t[0], t[1], t[2])});
  }
  return poses;
}

}  // namespace

PlanarScene planar_scene(std::span<const RayPair> pairs, const RelativePose& best, const RelativePoseOptions& pose_options,
                         const PlanarAmbiguityOptions& options) {
  PlanarScene scene;
  const PlanePoints points = plane_points(pairs, best.inliers);
  constexpr std::size_t kMinPoints = 8;
  if (points.query.size() < kMinPoints) return scene;
  cv::Mat agrees;
  const double max_error = 1.5 * pose_options.max_error_rad;  // a transfer has two components, a Sampson distance one
  const cv::Mat homography = cv::findHomography(points.query, points.match, cv::RANSAC, max_error, agrees);
  if (homography.empty()) return scene;
  scene.planar_ratio = cv::countNonZero(agrees) / static_cast<double>(points.query.size());
  if (scene.planar_ratio < options.min_planar_ratio) return scene;
  for (const Pose& pose : poses_of(homography)) {
    auto rival = refine_relative_pose(pairs, pose, pose_options);
    if (!rival || rival->num_true < options.min_support_ratio * best.num_true) continue;
    if (!differ(rival->match_from_query, best.match_from_query, options)) {
      const RelativePose& closest = scene.closer ? *scene.closer : best;
      if (log_likelihood(*rival, pose_options.max_error_rad) > log_likelihood(closest, pose_options.max_error_rad)) {
        scene.closer = std::move(*rival);
      }
      continue;
    }
    const bool known = std::any_of(scene.rivals.begin(), scene.rivals.end(), [&](const RelativePose& other) {
      return !differ(rival->match_from_query, other.match_from_query, options);
    });
    if (!known) scene.rivals.push_back(std::move(*rival));
  }
  if (scene.closer) {
    std::erase_if(scene.rivals, [&](const RelativePose& rival) {
      return !differ(rival.match_from_query, scene.closer->match_from_query, options);
    });
  }
  std::stable_sort(scene.rivals.begin(), scene.rivals.end(),
                   [](const RelativePose& a, const RelativePose& b) { return a.num_true > b.num_true; });
  return scene;
}

}  // namespace fabloop
