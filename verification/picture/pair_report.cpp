// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/pair_report.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "verification/inlier_spread.h"
#include "verification/matching/match_consistency.h"
#include "verification/repeated_texture.h"

namespace fabloop {
namespace {

using Wanted = PairFigure::Wanted;

std::string number_text(double value) {
  constexpr double kCounts = 1e6;
  std::ostringstream text;
  if (std::floor(value) == value && std::abs(value) < kCounts) {
    text << static_cast<long>(value);
  } else {
    text.precision(4);
    text << value;
  }
  return text.str();
}

/// Figures that come to exist as the gates are passed.
class FigureList {
 public:
  void add(std::string_view name, std::string_view explanation, bool is_known, double value, Wanted wanted = Wanted::Anything,
           double threshold = 0) {
    figures_.push_back({name, explanation, is_known ? std::optional(value) : std::nullopt, wanted, threshold});
  }
  std::vector<PairFigure> take() { return std::move(figures_); }

 private:
  std::vector<PairFigure> figures_;
};

void add_gates(const Verification& found, const VerifierOptions& options, FigureList& list) {
  const bool has_pose = found.num_inliers > 0;
  const bool is_no_accident =
      has_pose && found.num_inliers >= options.min_inliers && found.log10_false_alarms <= options.max_log10_false_alarms;
  const bool is_single = is_no_accident && found.num_second_inliers < options.max_second_support * found.num_true;
  const bool is_spread = is_single && found.inlier_area >= options.min_inlier_area;
  const bool is_decided = is_spread && found.rotation_sigma_deg > 0;
  list.add("looks", "2: with all features, where the first ones prove nothing, or thinly", true, found.num_looks);
  list.add("matches", "features that look alike", true, found.num_matches, Wanted::AtLeast, options.min_matches);
  list.add("inliers", "matches that agree with the pose", has_pose, found.num_inliers, Wanted::AtLeast, options.min_inliers);
  list.add("true_inliers", "inliers that are true, by their scatter", has_pose, found.num_true);
  list.add("log10_false_alarms", "models as good that accidents would make, as a power of ten", has_pose,
           found.log10_false_alarms, Wanted::AtMost, options.max_log10_false_alarms);
  list.add("second_support", "inliers of another pose among the left matches, over the true ones", is_no_accident,
           found.num_second_inliers / std::max(1.0, found.num_true), Wanted::AtMost, options.max_second_support);
  list.add("inlier_area", "share of the image inside the inliers' hull", is_single, found.inlier_area, Wanted::AtLeast,
           options.min_inlier_area);
  list.add("rotation_share", "share of the inliers that a rotation alone explains", is_spread, found.rotation_share,
           found.num_point_inliers > 0 ? Wanted::Anything : Wanted::AtMost, options.max_rotation_share);
  if (found.planar_lead) {
    list.add("planar_lead", "how much likelier than a plane's other pose, as a logarithm", true, *found.planar_lead,
             Wanted::AtLeast, kMinLead);
  }
  list.add("rotation_sigma_deg", "standard deviation of the rotation", is_decided, found.rotation_sigma_deg);
  list.add("translation_sigma", "standard deviation of the translation across its direction, over the depth", is_decided,
           found.translation_sigma, Wanted::AtMost, options.max_translation_sigma);
  if (found.has_scale) list.add("scale_sigma", "relative standard deviation of the distance", true, found.scale_sigma);
  if (found.num_point_inliers > 0) {
    list.add("point_inliers", "known points that agree with the pose", true, found.num_point_inliers);
  }
  if (found.num_window_inliers > 0) {
    list.add("window_inliers", "matches of the windows of keyframes that told the distance", true, found.num_window_inliers);
  }
  list.add("baseline_to_depth", "distance of the views over the depth of the scene", is_decided, found.baseline_to_depth);
  list.add("parallax_deg", "median angle between the inliers' rays", has_pose, found.median_parallax_deg);
  list.add("p_true", "probability that the loop is right", has_pose, found.p_true, Wanted::AtLeast, options.min_probability);
  list.add("rms_error_px", "of the inliers, from their epipolar lines", has_pose, found.rms_error_px);
  list.add("ransac_iterations", "models tried", has_pose, found.num_iterations);
}

void add_trust(const View& query, const View& match, const Verification& found, FigureList& list) {
  const bool has_inliers = !found.inliers.empty();
  const InlierSpread spread = inlier_spread(query, match, found.inliers);
  const RepeatedTexture texture = repeated_texture(query, match, found.inliers);
  const ViewChange change = view_change(query.features, match.features, found.inliers);
  list.add("cell_share", "share of an 8 x 8 grid that holds inliers, the lesser of both images", has_inliers,
           std::min(spread.query.cell_share, spread.match.cell_share));
  list.add("lookalike_share", "share of the inliers that have a look-alike in their own image", has_inliers,
           texture.lookalike_share);
  list.add("rivals_per_inlier", "other features nearly as similar", has_inliers, texture.mean_num_rivals);
  list.add("many_to_one_share", "share of the inliers whose spot another one has as well", has_inliers,
           texture.many_to_one_share);
  list.add("turn_deg", "how far the image turned, by its keypoints", change.turn_deg.has_value(),
           change.turn_deg ? change.turn_deg->value : 0);
  list.add("growth", "how much larger things are in the match, by its keypoints", change.log2_growth.has_value(),
           change.log2_growth ? std::exp2(change.log2_growth->value) : 0);
}

}  // namespace

std::optional<bool> PairFigure::is_passed() const {
  if (!value || wanted == Wanted::Anything) return std::nullopt;
  return wanted == Wanted::AtLeast ? *value >= threshold : *value <= threshold;
}

std::vector<PairFigure> pair_figures(const View& query, const View& match, const Verification& found,
                                     const VerifierOptions& options) {
  FigureList list;
  add_gates(found, options, list);
  add_trust(query, match, found, list);
  return list.take();
}

std::vector<PairFigure> gate_figures(const Verification& found, const VerifierOptions& options) {
  FigureList list;
  add_gates(found, options, list);
  return list.take();
}

std::string_view meaning_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::Accepted:
      return "both show one place";
    case Verdict::TooFewMatches:
      return "too few features look alike";
    case Verdict::NoPose:
      return "no pose explains even a handful of the matches";
    case Verdict::TooFewInliers:
      return "too few matches agree with the best pose";
    case Verdict::AccidentalInliers:
      return "as many matches would agree by accident";
    case Verdict::InliersInCorner:
      return "what agrees covers too little of the images";
    case Verdict::RepeatedTexture:
      return "another set of the matches has a pose of its own: texture that repeats";
    case Verdict::NoParallax:
      return "the views differ by a rotation, and no depth tells how far apart they are";
    case Verdict::AmbiguousPose:
      return "a plane, which another pose explains as well";
    case Verdict::ScaleDisagrees:
      return "the known points and the rays tell different poses";
    case Verdict::PoorlyConstrained:
      return "what agrees leaves the pose too uncertain";
    case Verdict::Improbable:
      return "all gates passed, but not as probable as asked for";
    case Verdict::Unconfirmed:
      return "proved, but consecutive images have not confirmed it yet";
    case Verdict::ContradictsMap:
      return "the rest of the map says otherwise";
  }
  return "";
}

std::string_view gate_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::TooFewMatches:
      return "matches";
    case Verdict::TooFewInliers:
      return "inliers";
    case Verdict::AccidentalInliers:
      return "log10_false_alarms";
    case Verdict::RepeatedTexture:
      return "second_support";
    case Verdict::InliersInCorner:
      return "inlier_area";
    case Verdict::NoParallax:
      return "rotation_share";
    case Verdict::AmbiguousPose:
      return "planar_lead";
    case Verdict::Improbable:
      return "p_true";
    default:
      return "";
  }
}

std::string wanted_text(const PairFigure& figure) {
  if (figure.wanted == Wanted::Anything) return "";
  return (figure.wanted == Wanted::AtLeast ? "at least " : "at most ") + number_text(figure.threshold);
}

std::string value_text(const PairFigure& figure) { return figure.value ? number_text(*figure.value) : "-"; }

}  // namespace fabloop
