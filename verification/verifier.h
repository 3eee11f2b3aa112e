// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/match_consistency.h"
#include "verification/matching/matching.h"
#include "verification/matching/similar_group.h"
#include "verification/matching/word_matching.h"
#include "verification/pose/plane_scale.h"
#include "verification/pose/pose_choice.h"
#include "verification/pose/scale.h"
#include "verification/verdict.h"
#include "verification/view.h"

namespace fabloop {

/// A pair that the first features do not prove is looked at again, with all of them, where that may help; so is one that they
/// prove thinly, since a few accidental inliers can bend its pose. The second look takes only matches that turn and grow like
/// most, so its ratio test may be laxer.
struct SecondLook {
  std::size_t num_first_features = 2000;  ///< Of the first look, whose time grows with their square.
  double min_true = 40;                   ///< With fewer true inliers a first look that accepts has not the last word, unless the
                                          ///< second finds fewer still; nor is a pose certain that accidents had bent.
  std::size_t min_similar = 4;            ///< Least largest_similar_group() of the first look's matches that is worth another.
  double max_ratio = 0.9;                 ///< Of the second look; the first has MatchingOptions::max_ratio.
  SimilarGroupOptions similar;
};

/// Which features of two views are compared in the first look.
enum class MatchBy {
  Features,  ///< All with all.
  Words,     ///< Those of one word: see word_matching.h. For many features and many hypotheses a frame: some loops are missed.
};

struct VerifierOptions {
  MatchBy match_by = MatchBy::Features;  ///< Words only where both views name the words of their features; Features elsewhere.
  WordMatchingOptions word_matching;     ///< Its `matching` is the one below.
  MatchingOptions matching;
  SecondLook second_look;
  /// Which matches turn and grow alike: accidents seldom do.
  MatchConsistencyOptions consistency{.max_turn_difference_deg = 30};
  /// Makes a proven but uncertain pose more certain by matches along its epipolar lines; see guided_matching.h. It saves a few
  /// loops between views that hardly overlap, the least reliable ones.
  bool guided = false;
  int min_matches = 20;  ///< Fewer are not worth a RANSAC.
  int min_inliers = 15;  ///< The field's usual least; the accidental-inlier gate asks for more where matches abound.
  /// Largest distance from the epipolar plane, pixels of the match's image as its features were found (Features::pixel_size).
  /// Raise it for badly known lenses and rolling shutters.
  double max_error_px = 2.0;
  /// The same for known points, whose own error adds to the pixel's.
  double max_point_error_px = 4.0;
  double max_log10_false_alarms = -8.0;  ///< Accepted accidents: at most one in 10^8 pairs of accidental matches.
  /// Least share of either image that the inliers' convex hull covers. How certain a pose from a small part of the image is, its
  /// covariance says (max_rotation_sigma); this is for what no scatter shows: errors of the lens that are alike all over the
  /// part.
  double min_inlier_area = 0.025;
  /// Another pose that so large a share of as many of the left matches agree with makes the texture a repeated one.
  double max_second_support = 0.6;
  /// Inliers that a rotation alone may explain, as a share: above it the views have no parallax.
  double max_rotation_share = 0.8;
  ScaleOptions scale;
  PlaneScaleOptions plane_scale;  ///< Where no points tell it.
  // Where there is no parallax, the pose comes from known points alone:
  double min_point_inlier_ratio = 0.5;  ///< Of the epipolar inliers that have depth, how many must agree with the metric pose.
  /// Share of the epipolar inliers that the metric pose must keep: points and rays must tell one story.
  double min_ray_inlier_ratio = 0.7;
  /// Largest standard deviation of the rotation, as a share of the field of view. Loops worse than this bend a map more than
  /// they mend it.
  double max_rotation_sigma = 0.012;
  double max_translation_sigma = 0.045;  ///< The same of the translation across its direction, as a share of the median depth.
  double max_direction_sigma = 0.12;     ///< The same for loops without scale, as a share of the baseline too: radians.
  double scale_sigma = 0.05;             ///< Relative standard deviation of the unit of length: the odometry's step error.
  /// Largest standard deviation of the distance between the views, as a share of the median depth. Loops between views further
  /// apart state a direction only.
  double max_distance_sigma = 0.035;
  /// Loops less probable than this are refused: 0.999 for at most one false loop in 1000. 0 leaves it to the other gates.
  double min_probability = 0;
  double confidence = 0.999;  ///< RANSAC's.
  int max_iterations = 2000;  ///< RANSAC's bound: time spent on false candidates.
  std::uint64_t seed = 0;     ///< Combined with the frames' numbers, so that order does not matter.
};

/// What was found out about a pair of views, as far as the gates were passed.
struct Verification {
  Verdict verdict = Verdict::TooFewMatches;
  double p_true = 0;  ///< Probability that the loop is right; see loop_probability.h. 0 without a pose.
  int num_looks = 1;  ///< See SecondLook.
  int num_matches = 0;
  int num_inliers = 0;                ///< Epipolar.
  double num_true = 0;                ///< Expected number of true ones among them; see inlier_noise.h.
  int num_point_inliers = 0;          ///< Of the metric pose.
  int num_window_inliers = 0;         ///< Of the windows that told the pose's length; see window_scale.h.
  double log10_false_alarms = 0;      ///< See evidence.h.
  double inlier_area = 0;             ///< Share of the image inside the inliers' convex hull, the smaller of both images.
  double inlier_cells = 0;            ///< Share of the cells of a grid that hold an inlier, the smaller of both images.
  int num_second_inliers = 0;         ///< Of the best pose among the matches that are none.
  std::optional<double> planar_lead;  ///< How far the pose leads the other one of a plane, as PoseChoice::lead.
  double rotation_share = 0;          ///< Of the inliers, how many a rotation alone explains.
  double baseline_to_depth = 0;       ///< Length of the translation over the median depth.
  double median_parallax_deg = 0;     ///< Between the inliers' rays, rotation undone.
  double rotation_sigma_deg = 0;
  double translation_sigma = 0;  ///< Across its direction, as a share of the median depth.
  double scale_sigma = 0;        ///< Relative, of the distance between the views; 0 without scale.
  double rms_error_px = 0;       ///< Of the epipolar inliers; the pixels are those of max_error_px.
  int num_iterations = 0;        ///< RANSAC's, of the relative pose.
  Pose match_from_query;         ///< Translation in metres (has_scale) or a unit direction. Meaningful from AccidentalInliers on.
  bool has_scale = false;
  /// Of (translation, rotation) of match_from_query, in the order and on the tangent (translation in the match, rotation in
  /// the query) of a pose-graph edge. Without scale it has no information along the direction.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<Match> inliers;  ///< The matches that agree.
};

/// What is known of a pair before its features are compared.
struct PairPrior {
  std::optional<PosePrior> pose =
      {};                     ///< Tells the two poses of a plane apart, and lowers the probability of what contradicts it.
  double p_appearance = 0.5;  ///< Probability of the place by appearance; see LoopEvidence.
};

/// The probability that a loop with a pose is right; see loop_probability.h.
double loop_probability(const Verification& found, const PairPrior& prior);

/// Proves or rejects that two views show one place: match, relative pose (five points), the pose among those of a plane, the
/// length of its translation where depth is known on either side. Deterministic; const, so any number of calls may run in
/// parallel.
class Verifier {
 public:
  explicit Verifier(const VerifierOptions& options = {}) : options_(options) {}
  Verification verify(const View& query, const View& match, const PairPrior& prior = {}) const;
  const VerifierOptions& options() const { return options_; }

 private:
  VerifierOptions options_;
};

}  // namespace fabloop
