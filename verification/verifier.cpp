// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "frontend/features/spatially_even.h"
#include "verification/evidence.h"
#include "verification/inlier_spread.h"
#include "verification/loop_probability.h"
#include "verification/matching/guided_matching.h"
#include "verification/matching/spots.h"
#include "verification/matching/word_matching.h"
#include "verification/pair_decision.h"
#include "verification/pair_seed.h"
#include "verification/pose/lone_depths.h"
#include "verification/pose/ray_pairs.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {
namespace {

LoopEvidence evidence_of(const Verification& found, const PairPrior& prior) {
  LoopEvidence evidence;
  evidence.p_appearance = prior.p_appearance;
  evidence.log10_false_alarms = found.log10_false_alarms;
  if (!prior.pose || found.information.isZero()) return evidence;
  Pose pose = found.match_from_query;
  if (!found.has_scale) pose.translation *= prior.pose->match_from_query.translation.norm();
  evidence.squared_distance = squared_distance(pose, *prior.pose);
  evidence.degrees_of_freedom = found.has_scale ? 6 : 5;
  return evidence;
}

/// The options of a pair whose points have a unit of length that is known so well.
VerifierOptions of_unit(VerifierOptions options, double unit_sigma) {
  options.scale_sigma = std::max(options.scale_sigma, unit_sigma);
  return options;
}

bool has_words(const View& view) { return view.words.size() == view.features.keypoints.size(); }

/// Of the first features of two views, which have the first of the views' words.
std::vector<Match> match_words(const View& query, const Features& query_first, const View& match, const Features& match_first,
                               const VerifierOptions& options) {
  WordMatchingOptions of_words = options.word_matching;
  of_words.matching = options.matching;
  return match_shared_words(query_first, std::span(query.words).first(query_first.keypoints.size()), match_first,
                            std::span(match.words).first(match_first.keypoints.size()), of_words);
}

/// The gates that the matches of a pair pass, in their order; the first that fails names the verdict.
class Gates {
 public:
  /// `others` are matches that no pose was looked for among; they may tell another one.
  Gates(const View& query, const View& match, std::vector<Match> matches, std::vector<Match> others, const PairPrior& prior,
        const VerifierOptions& options)
      : query_(query),
        match_(match),
        matches_(std::move(matches)),
        others_(std::move(others)),
        prior_(prior),
        options_(options),
        pairs_(ray_pairs(query, match, matches_)) {
    pose_options_.max_error_rad = options.max_error_px / feature_focal_px(match);
    pose_options_.confidence = options.confidence;
    pose_options_.max_iterations = options.max_iterations;
    pose_options_.seed = pair_seed(options.seed, query.frame, match.frame);
    pose_options_.min_inliers = static_cast<std::size_t>(std::max(0, options.min_inliers));
    result_.num_matches = static_cast<int>(matches_.size());
  }

  Verification pass() && {
    if (result_.num_matches < options_.min_matches) return std::move(result_);
    auto best = estimate_relative_pose(pairs_, pose_options_);
    result_.verdict = Verdict::NoPose;
    if (!best) return std::move(result_);
    result_.num_iterations = best->iterations;
    choose(std::move(*best));
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds && set_bending_accidents_aside(); ++round) {
    }
    if (!is_evidence()) return std::move(result_);
    decide();
    if (options_.guided && result_.verdict == Verdict::PoorlyConstrained && add_guided_matches()) decide();
    return std::move(result_);
  }

 private:
  bool fail(Verdict verdict) {
    result_.verdict = verdict;
    return false;
  }

  /// The pose, or another of the same plane, and its inliers.
  void choose(RelativePose found) {
    choice_ =
        choose_pose(query_, match_, matches_, pairs_, std::move(found), {pose_options_, options_.scale, options_.plane_scale},
                    prior_.pose, ray_pairs(query_, match_, accidents_));
    const RelativePose& relative = choice_.chosen.relative;
    result_.inliers.clear();
    for (const std::size_t i : relative.inliers) result_.inliers.push_back(matches_[i]);
    result_.match_from_query = relative.match_from_query;
    result_.num_inliers = static_cast<int>(relative.inliers.size());
    result_.num_true = relative.num_true;
    result_.rms_error_px = relative.noise_rad * feature_focal_px(match_);
    result_.median_parallax_deg = deg_from_rad(median_parallax(pairs_, relative.inliers, relative.match_from_query));
  }

  /// Takes accidents that bend the pose out of the matches, and finds it anew. Whether there were any.
  bool set_bending_accidents_aside() {
    LoneDepthOptions of_depths;
    of_depths.line_length_rad = field_of_view_rad(match_.camera);
    const auto bending = find_bending_accidents(pairs_, choice_.chosen.relative, pose_options_, of_depths);
    if (!bending) return false;
    std::vector<Match> kept, accidents;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      (std::ranges::binary_search(bending->inliers, i) ? accidents : kept).push_back(matches_[i]);
    }
    std::vector<RayPair> pairs = ray_pairs(query_, match_, kept);
    auto refined = refine_relative_pose(pairs, bending->match_from_query, pose_options_);
    if (!refined) return false;
    accidents_.insert(accidents_.end(), accidents.begin(), accidents.end());
    matches_ = std::move(kept);
    pairs_ = std::move(pairs);
    choose(std::move(*refined));
    return true;
  }

  /// Whether the inliers prove anything: they are many, no accident, and without a rival.
  bool is_evidence() {
    result_.log10_false_alarms = false_alarms();
    result_.p_true = loop_probability({prior_.p_appearance, result_.log10_false_alarms, {}, {}});
    if (result_.num_inliers < options_.min_inliers) return fail(Verdict::TooFewInliers);
    if (result_.log10_false_alarms > options_.max_log10_false_alarms) return fail(Verdict::AccidentalInliers);
    result_.num_second_inliers = second_support();
    if (result_.num_second_inliers >= options_.max_second_support * result_.num_true) return fail(Verdict::RepeatedTexture);
    return true;
  }

  /// Largest number of inliers that the matches left by the pose have for another one.
  int second_support() const {
    std::vector<Match> left = others_;
    left.insert(left.end(), accidents_.begin(), accidents_.end());
    std::size_t next = 0;
    const std::vector<std::size_t>& inliers = choice_.chosen.relative.inliers;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      if (next < inliers.size() && inliers[next] == i) {
        ++next;
      } else {
        left.push_back(matches_[i]);
      }
    }
    RelativePoseOptions second = pose_options_;
    second.min_inliers = static_cast<std::size_t>(std::ceil(options_.max_second_support * result_.num_true));
    if (left.size() < std::max<std::size_t>(second.min_inliers, 6)) return 0;
    left = most_distinctive_first(std::move(left), query_.features, 0);
    const auto other = estimate_relative_pose(ray_pairs(query_, match_, left), second);
    return other ? static_cast<int>(other->inliers.size()) : 0;
  }

  /// Of all matches, or of those that turn and grow like most: accidents seldom do, and count for less among them.
  double false_alarms() const {
    constexpr double kFivePointModels = 10;
    constexpr double kTests = 0.3;  // log10 of two: the better of both is taken
    const double p_accident = p_accidental_epipolar_match(match_, options_.max_error_px);
    const std::size_t num_matches = matches_.size() + accidents_.size();
    const double of_all = log10_false_alarms(num_matches, result_.inliers.size(), 5, p_accident, kFivePointModels);
    const ViewChange change = view_change(query_.features, match_.features, matches_, options_.consistency);
    const auto count = [&](const std::vector<Match>& matches) {
      return static_cast<std::size_t>(std::count_if(matches.begin(), matches.end(), [&](const Match& m) {
        return agrees_with(change, query_.features, match_.features, m, options_.consistency);
      }));
    };
    const std::size_t num_similar = count(matches_) + count(accidents_);
    return std::min(of_all, log10_false_alarms(num_similar, count(result_.inliers), 5, p_accident, kFivePointModels)) + kTests;
  }

  /// More matches along the epipolar lines of the pose. They agree with it by construction: they make it more certain, but count
  /// for nothing in what proved it.
  bool add_guided_matches() {
    // Wide enough for the accidents among them to be told by their residuals.
    constexpr double kBand = 3.0;
    // About a pose that is off, accidents abound among what a band offers.
    constexpr double kMinTrueShare = 0.85;
    GuidedMatchingOptions guided;
    guided.max_error_rad = kBand * pose_options_.max_error_rad;
    guided.max_ratio = options_.matching.max_ratio;
    guided.same_spot_px = options_.matching.same_spot_px;
    guided.change = view_change(query_.features, match_.features, result_.inliers, options_.consistency);
    guided.consistency = options_.consistency;
    std::vector<Match> more = guided_matches(query_, match_, choice_.chosen.relative.match_from_query, guided);
    std::erase_if(more, [&](const Match& m) {
      return std::ranges::any_of(accidents_, [&](const Match& a) { return a.query == m.query && a.match == m.match; });
    });
    std::vector<char> has_match(query_.features.keypoints.size(), 0);
    for (const Match& m : more) has_match[static_cast<std::size_t>(m.query)] = 1;
    std::copy_if(matches_.begin(), matches_.end(), std::back_inserter(more),
                 [&](const Match& m) { return !has_match[static_cast<std::size_t>(m.query)]; });
    more = most_distinctive_first(std::move(more), query_.features, 0);
    std::vector<RayPair> pairs = ray_pairs(query_, match_, more);
    auto refined = refine_relative_pose(pairs, choice_.chosen.relative.match_from_query, pose_options_);
    if (!refined || refined->num_true <= result_.num_true) return false;
    if (refined->num_true < kMinTrueShare * static_cast<double>(refined->inliers.size())) return false;
    matches_ = std::move(more);
    pairs_ = std::move(pairs);
    choose(std::move(*refined));
    return true;
  }

  /// Where the views are, and how surely.
  void decide() {
    const InlierSpread spread = inlier_spread(query_, match_, result_.inliers);
    result_.inlier_area = std::min(spread.query.hull_share, spread.match.hull_share);
    result_.inlier_cells = std::min(spread.query.cell_share, spread.match.cell_share);
    if (result_.inlier_area < options_.min_inlier_area) return void(fail(Verdict::InliersInCorner));
    // What a rotation leaves has two components and both images' noise; a few inliers may tell too small a noise.
    const RelativePose& relative = choice_.chosen.relative;
    const double max_rotation_error_rad = std::max(4.0 * relative.noise_rad, 0.5 * pose_options_.max_error_rad);
    result_.rotation_share = fit_rotation(pairs_, relative.inliers, max_rotation_error_rad).share;
    if (result_.rotation_share > options_.max_rotation_share) {
      decide_by_points(query_, match_, matches_, pairs_, pose_options_,
                       of_unit(options_, std::max(query_.unit_sigma, match_.unit_sigma)), result_);
    } else {
      result_.planar_lead = choice_.lead;
      if (choice_.lead && *choice_.lead < kMinLead) return void(fail(Verdict::AmbiguousPose));
      decide_by_rays(pairs_, choice_.chosen, of_unit(options_, choice_.chosen.unit_sigma), result_);
    }
    // Where few true inliers are left of those that accidents were among, more accidents may be.
    const bool is_suspect = !accidents_.empty() && result_.num_true < options_.second_look.min_true;
    const bool vague =
        is_suspect || rad_from_deg(result_.rotation_sigma_deg) > options_.max_rotation_sigma * field_of_view_rad(match_.camera) ||
        result_.translation_sigma > options_.max_translation_sigma;
    if (result_.verdict == Verdict::Accepted && vague) fail(Verdict::PoorlyConstrained);
    result_.p_true = loop_probability(result_, prior_);
    if (result_.verdict == Verdict::Accepted && result_.p_true < options_.min_probability) fail(Verdict::Improbable);
  }

  const View& query_;
  const View& match_;
  std::vector<Match> matches_, others_;
  std::vector<Match> accidents_;  ///< Taken out of the matches, since they bent the pose.
  const PairPrior& prior_;
  const VerifierOptions& options_;
  std::vector<RayPair> pairs_;
  RelativePoseOptions pose_options_;
  PoseChoice choice_;
  Verification result_;
};

}  // namespace

double loop_probability(const Verification& found, const PairPrior& prior) { return loop_probability(evidence_of(found, prior)); }

Verification Verifier::verify(const View& query, const View& match, const PairPrior& prior) const {
  const SecondLook& look = options_.second_look;
  const Features query_first = first_features(query.features, look.num_first_features);
  const Features match_first = first_features(match.features, look.num_first_features);
  const std::vector<Match> matches = options_.match_by == MatchBy::Words && has_words(query) && has_words(match)
                                         ? match_words(query, query_first, match, match_first, options_)
                                         : match_features(query_first, match_first, options_.matching);
  Verification first = Gates(query, match, matches, {}, prior, options_).pass();
  const bool is_accepted = first.verdict == Verdict::Accepted;
  if (is_accepted && first.num_true >= look.min_true) return first;
  if (largest_similar_group(query_first, match_first, matches, look.similar) < look.min_similar) return first;
  MatchingOptions lax = options_.matching;
  lax.max_ratio = std::max(lax.max_ratio, look.max_ratio);
  std::vector<Match> consistent = match_features(query.features, match.features, lax);
  const ViewChange change = view_change(query.features, match.features, consistent, options_.consistency);
  const auto others = std::stable_partition(consistent.begin(), consistent.end(), [&](const Match& m) {
    return agrees_with(change, query.features, match.features, m, options_.consistency);
  });
  std::vector<Match> inconsistent(others, consistent.end());
  consistent.erase(others, consistent.end());
  Verification second = Gates(query, match, std::move(consistent), std::move(inconsistent), prior, options_).pass();
  second.num_looks = 2;
  return is_accepted && second.num_true < first.num_true ? first : second;
}

}  // namespace fabloop
