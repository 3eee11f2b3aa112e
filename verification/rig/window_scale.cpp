// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/window_scale.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cassert>
#include <cmath>

#include "verification/chi_square.h"
#include "verification/edge_information.h"
#include "verification/pair_decision.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Whether the pair's pose, whose translation is a direction, is the windows' but for its length.
bool tells_the_same(const Verification& pair, const Pose& windows, const Matrix6d& covariance_of_windows) {
  // Both rest on the pair's matches, so that they differ by less than their covariances say.
  constexpr double kQuantile = 0.999;
  const double distance = windows.translation.norm();
  Matrix6d unit = Matrix6d::Identity();
  unit.topLeftCorner<3, 3>() /= distance;
  const Pose direction{windows.rotation, windows.translation / distance};
  const Eigen::Matrix<double, 6, 1> error = pose_error(pair.match_from_query, direction);
  const Matrix6d covariance = covariance_of(pair.information) + unit * covariance_of_windows * unit.transpose();
  return error.dot(covariance.llt().solve(error)) <= chi_square_quantile(kQuantile, 6);
}

}  // namespace

std::optional<Verification> scale_by_windows(const Verification& pair, std::span<const WindowView> query,
                                             std::span<const WindowView> match, const WindowOptions& window_options,
                                             const VerifierOptions& options) {
  assert(pair.verdict == Verdict::Accepted && !pair.has_scale);
  const auto found = verify_windows(query, match, window_options);
  if (!found || !found->has_scale || found->log10_false_alarms > options.max_log10_false_alarms) return std::nullopt;
  const double distance = found->match_from_query.translation.norm();
  const double relative_sigma = std::hypot(found->scale_sigma, options.scale_sigma);
  if (!(relative_sigma * pair.baseline_to_depth <= options.max_distance_sigma)) return std::nullopt;
  const double median_depth = distance / pair.baseline_to_depth;
  const EdgeInformation edge =
      metric_edge_information(found->match_from_query, found->information.inverse(), median_depth, options.scale_sigma);
  if (!(edge.translation_sigma <= options.max_translation_sigma * median_depth)) return std::nullopt;
  if (!(edge.rotation_sigma_rad <= options.max_rotation_sigma * field_of_view_rad(match.front().view->camera)))
    return std::nullopt;
  if (!tells_the_same(pair, found->match_from_query, edge.information.inverse())) return std::nullopt;
  Verification scaled = pair;
  scaled.match_from_query = found->match_from_query;
  scaled.information = edge.information;
  scaled.has_scale = true;
  scaled.scale_sigma = relative_sigma;
  scaled.rotation_sigma_deg = deg_from_rad(edge.rotation_sigma_rad);
  scaled.translation_sigma = edge.translation_sigma / median_depth;
  scaled.num_window_inliers = static_cast<int>(found->inliers.size());
  return scaled;
}

}  // namespace fabloop
