// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching.h"
#include "verification/view.h"

namespace fabloop {

/// Every way in which a hypothesis can end. The first gate that fails names it.
enum class Verdict {
  Accepted,
  TooFewMatches,      ///< Too few features of the two views look alike.
  NoPose,             ///< No relative pose explains even a handful of the matches.
  TooFewInliers,      ///< Fewer matches agree with the best pose than asked for.
  AccidentalInliers,  ///< As many would agree by accident.
  InliersInCorner,    ///< The inliers cover too little of either image: the views touch rather than overlap.
  NoParallax,         ///< The views differ by a rotation, and no depth tells how far apart they are.
  AmbiguousPose,      ///< A different pose explains the same matches as well: a plane seen without depth.
  ScaleDisagrees,     ///< The known points and the rays alone give different poses.
  PoorlyConstrained,  ///< The inliers leave the pose too uncertain: they lie in a corner, say.
  Unconfirmed,        ///< Proved, but not yet seen by enough consecutive queries. Only a loop closer can tell.
  ContradictsMap,     ///< Proved by its images, but the rest of the map says otherwise. Only a map can tell.
};

/// The enumerator's name.
std::string_view to_string(Verdict verdict);

struct VerifierOptions {
  MatchingOptions matching;
  int min_matches = 20;  ///< Fewer are not worth a RANSAC.
  int min_inliers = 15;  ///< The field's usual least; the accidental-inlier gate asks for more where matches abound.
  /// Largest distance from the epipolar plane, pixels of the match. Raise it for badly known lenses and rolling shutters.
  double max_error_px = 2.0;
  /// The same for known points, whose own error adds to the pixel's.
  double max_point_error_px = 4.0;
  double max_log10_false_alarms = -3.0;  ///< Accepted accidents: at most one pair in 1000 of accidental matches.
  /// Least share of either image that the inliers' convex hull covers. Pairs that merely touch leave the pose to a few pixels.
  double min_inlier_area = 0.07;
  int min_points = 12;                  ///< Inliers with known depth from which scale is taken.
  double min_point_inlier_ratio = 0.5;  ///< Of the epipolar inliers that have depth, how many must agree with the metric pose.
  /// Share of the epipolar inliers that the metric pose must keep: points and rays must tell one story.
  double min_ray_inlier_ratio = 0.7;
  double min_parallax_deg = 1.0;  ///< Below it the direction between two views without known depth means nothing.
  /// Largest standard deviation of the rotation. Loops worse than this bend a map more than they mend it.
  double max_rotation_sigma_deg = 1.0;
  double max_direction_sigma_deg = 5.0;  ///< The same for the direction of translation of loops without scale.
  double max_translation_sigma = 0.03;   ///< The same for loops with scale, as a share of the median depth.
  double scale_sigma = 0.05;             ///< Relative standard deviation of the unit of length: the odometry's step error.
  /// Largest standard deviation of the distance between the views that `scale_sigma` causes, as a share of the median depth.
  /// Loops between views further apart state a direction only.
  double max_distance_sigma = 0.035;
  double confidence = 0.999;  ///< RANSAC's.
  int max_iterations = 1500;  ///< RANSAC's bound: time spent on false candidates.
  std::uint64_t seed = 0;     ///< Combined with the frames' numbers, so that order does not matter.
};

/// What was found out about a pair of views, as far as the gates were passed.
struct Verification {
  Verdict verdict = Verdict::TooFewMatches;
  int num_matches = 0;
  int num_inliers = 0;             ///< Epipolar.
  int num_point_inliers = 0;       ///< Of the metric pose.
  double log10_false_alarms = 0;   ///< See evidence.h.
  double inlier_area = 0;          ///< Share of the image inside the inliers' convex hull, the smaller of both images.
  double median_parallax_deg = 0;  ///< Between the inliers' rays, rotation undone.
  double rotation_sigma_deg = 0;
  double translation_sigma = 0;  ///< With scale: share of the median depth. Without: radians of direction.
  double rms_error_px = 0;       ///< Of the epipolar inliers.
  int num_iterations = 0;        ///< RANSAC's, of the relative pose.
  Pose match_from_query;         ///< Translation in metres (has_scale) or a unit direction. Meaningful from AccidentalInliers on.
  bool has_scale = false;
  /// Of (translation, rotation) of match_from_query, in the order and on the tangent (translation in the match, rotation in
  /// the query) of a pose-graph edge. Without scale it has no information along the direction.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<Match> inliers;  ///< The matches that agree.
};

/// Proves or rejects that two views show one place: match, relative pose (five points), then the metric pose (three points)
/// where depth is known on either side. Deterministic; const, so any number of calls may run in parallel.
class Verifier {
 public:
  explicit Verifier(const VerifierOptions& options = {}) : options_(options) {}
  Verification verify(const View& query, const View& match) const;
  const VerifierOptions& options() const { return options_; }

 private:
  VerifierOptions options_;
};

/// A seed for one pair of frames.
std::uint64_t pair_seed(std::uint64_t seed, std::size_t query, std::size_t match);

}  // namespace fabloop
