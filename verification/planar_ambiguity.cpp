// SPDX-License-Identifier: BSD-3-Clause
#include "verification/planar_ambiguity.h"

#include <opencv2/calib3d.hpp>
#include <optional>
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

std::optional<cv::Mat> homography_of_plane(std::span<const RayPair> pairs, const RelativePose& best, double max_error,
                                           double min_planar_ratio) {
  const PlanePoints points = plane_points(pairs, best.inliers);
  constexpr std::size_t kMinPoints = 8;
  if (points.query.size() < kMinPoints) return std::nullopt;
  cv::Mat agrees;
  const cv::Mat match_from_query = cv::findHomography(points.query, points.match, cv::RANSAC, max_error, agrees);
  if (match_from_query.empty()) return std::nullopt;
  if (cv::countNonZero(agrees) < min_planar_ratio * static_cast<double>(points.query.size())) return std::nullopt;
  return match_from_query;
}

}  // namespace

bool has_planar_rival(std::span<const RayPair> pairs, const RelativePose& best, const RelativePoseOptions& pose_options,
                      const PlanarAmbiguityOptions& options) {
  const auto homography = homography_of_plane(pairs, best, 1.5 * pose_options.max_error_rad, options.min_planar_ratio);
  if (!homography) return false;
  std::vector<cv::Mat> rotations, translations, normals;
  cv::decomposeHomographyMat(*homography, cv::Mat::eye(3, 3, CV_64F), rotations, translations, normals);
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    Eigen::Matrix3d rotation;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) rotation(r, c) = rotations[k].at<double>(r, c);
    }
    const Eigen::Vector3d translation(translations[k].at<double>(0), translations[k].at<double>(1),
                                      translations[k].at<double>(2));
    const auto rival = refine_relative_pose(pairs, {Eigen::Quaterniond(rotation).normalized(), translation}, pose_options);
    if (!rival) continue;
    const Pose& a = best.match_from_query;
    const Pose& b = rival->match_from_query;
    const bool differs = deg_from_rad(a.rotation.angularDistance(b.rotation)) > options.min_rotation_deg ||
                         deg_from_rad(angle_between(a.translation, b.translation)) > options.min_direction_deg;
    const double support = static_cast<double>(rival->inliers.size()) / static_cast<double>(best.inliers.size());
    if (differs && support > options.min_support_ratio) return true;
  }
  return false;
}

}  // namespace fabloop
