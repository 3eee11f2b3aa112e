// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/loop_evaluation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "frontend/error.h"

namespace fabloop {
namespace {

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  // A direction of length zero is across everything.
  if (a.norm() == 0.0 || b.norm() == 0.0) return 90.0;
  return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

const Pose* reference_of(const LoopTruth& truth, std::size_t frame) {
  if (frame >= truth.world_from_camera.size()) {
    throw InputError("loops.csv: frame " + std::to_string(frame) + " is beyond the " +
                     std::to_string(truth.world_from_camera.size()) +
                     " frames of the truth; is it the truth of another sequence?");
  }
  return truth.world_from_camera[frame] ? &*truth.world_from_camera[frame] : nullptr;
}

/// Whether the frames show one place, as far as the truth knows.
MatchTruth pair_of(const LoopRecord& record, const Pose& match_from_query, const LoopTruth& truth,
                   const LoopEvaluationOptions& options) {
  if (truth.pairs) return judge_pair(pair_between(*truth.pairs, record.query, record.match), options.pairs);
  const bool is_far = options.false_radius_m && match_from_query.translation.norm() > *options.false_radius_m;
  return is_far ? MatchTruth::False : MatchTruth::True;
}

/// Fills the errors of the pose; true when it is within the rules.
bool pose_agrees(const LoopRecord& record, const Pose& match_from_query, const LoopEvaluationOptions& options, JudgedLoop& loop) {
  const Pose& measured = *record.match_from_query;
  const double max_translation_m = options.max_translation_error * options.height_above_ground_m;
  loop.rotation_error_deg = deg_from_rad(rotation_angle(measured.rotation.conjugate() * match_from_query.rotation));
  if (loop.rotation_error_deg > options.max_rotation_error_deg) return false;
  if (record.has_scale) return loop.translation_error_m <= max_translation_m;
  const bool has_baseline = match_from_query.translation.norm() > max_translation_m;
  return !has_baseline || loop.direction_error_deg <= options.max_direction_error_deg;
}

double query_recall(const std::vector<JudgedLoop>& loops, const LoopTruth& truth, const LoopEvaluationOptions& options) {
  std::set<std::size_t> wanted;
  for (const auto& [frames, pair] : *truth.pairs) {
    if (pair.overlap >= options.min_recall_overlap) wanted.insert(frames.second);
  }
  std::set<std::size_t> found;
  for (const JudgedLoop& loop : loops) {
    if (loop.judgement == LoopJudgement::True && wanted.count(loop.query)) found.insert(loop.query);
  }
  return static_cast<double>(found.size()) / static_cast<double>(std::max<std::size_t>(1, wanted.size()));
}

double pair_recall(const std::vector<JudgedLoop>& loops, const LoopTruth& truth, const LoopEvaluationOptions& options) {
  std::set<std::pair<std::size_t, std::size_t>> found;
  for (const JudgedLoop& loop : loops) {
    if (loop.judgement == LoopJudgement::True) found.insert(std::minmax(loop.query, loop.match));
  }
  std::size_t num_wanted = 0;
  std::size_t num_found = 0;
  for (const auto& [frames, pair] : *truth.pairs) {
    if (judge_pair(pair, options.pairs) != MatchTruth::True || frames.second - frames.first <= options.exclusion_window) continue;
    ++num_wanted;
    num_found += found.count(frames);
  }
  return static_cast<double>(num_found) / static_cast<double>(std::max<std::size_t>(1, num_wanted));
}

}  // namespace

double false_radius_m(const PoseRules& places, double height_above_ground_m, std::optional<double> wanted_m) {
  constexpr double kHeights = 3.0;
  if (wanted_m && *wanted_m < places.radius_m) {
    std::ostringstream text;
    text << "pairs beyond " << *wanted_m << " m cannot be false where those within " << places.radius_m
         << " m are true; give a larger false radius";
    throw InputError(text.str());
  }
  return wanted_m.value_or(std::max(places.radius_m, kHeights * height_above_ground_m));
}

JudgedLoop judge_loop(const LoopRecord& record, const LoopTruth& truth, const LoopEvaluationOptions& options) {
  JudgedLoop loop{record.query, record.match};
  const Pose* world_from_query = reference_of(truth, record.query);
  const Pose* world_from_match = reference_of(truth, record.match);
  if (!world_from_query || !world_from_match) return loop;

  const Pose match_from_query = world_from_match->inverse() * *world_from_query;
  const Eigen::Vector3d& measured = record.match_from_query->translation;
  (record.has_scale ? loop.translation_error_m : loop.direction_error_deg) =
      record.has_scale ? (measured - match_from_query.translation).norm() : angle_deg(measured, match_from_query.translation);
  const bool agrees = pose_agrees(record, match_from_query, options, loop);

  const auto [first, second] = std::minmax(record.query, record.match);
  const bool near_in_time = second - first <= options.exclusion_window;
  const MatchTruth pair = pair_of(record, match_from_query, truth, options);
  if (pair == MatchTruth::False && !near_in_time) {
    loop.judgement = LoopJudgement::FalsePair;
  } else if (!agrees) {
    loop.judgement = LoopJudgement::FalsePose;
  } else if (pair == MatchTruth::True || near_in_time) {
    loop.judgement = LoopJudgement::True;
  } else {
    loop.judgement = LoopJudgement::UnclearPair;
  }
  return loop;
}

LoopEvaluation evaluate_loops(const std::vector<LoopRecord>& records, const LoopTruth& truth,
                              const LoopEvaluationOptions& options) {
  LoopEvaluation result;
  result.num_hypotheses = records.size();
  for (const LoopRecord& record : records) {
    if (!record.accepted() || !record.match_from_query) continue;
    const JudgedLoop loop = judge_loop(record, truth, options);
    ++result.num_accepted;
    switch (loop.judgement) {
      case LoopJudgement::True:
        ++result.num_true;
        break;
      case LoopJudgement::FalsePair:
      case LoopJudgement::FalsePose:
        ++result.num_false;
        break;
      case LoopJudgement::NoReference:
      case LoopJudgement::UnclearPair:
        ++result.num_unjudged;
        break;
    }
    if (record.has_scale && loop.judgement != LoopJudgement::NoReference) ++result.num_with_scale;
    result.loops.push_back(loop);
  }
  const std::size_t num_judged = result.num_true + result.num_false;
  if (num_judged > 0) result.precision = static_cast<double>(result.num_true) / static_cast<double>(num_judged);
  if (truth.pairs) {
    result.query_recall = query_recall(result.loops, truth, options);
    result.pair_recall = pair_recall(result.loops, truth, options);
  }
  return result;
}

std::string pose_recipe(const LoopEvaluationOptions& options) {
  std::ostringstream text;
  text << "a pose is false beyond " << options.max_rotation_error_deg << " deg or " << 100.0 * options.max_translation_error
       << " % of " << options.height_above_ground_m
       << " m height above ground (without scale: " << options.max_direction_error_deg << " deg of direction)";
  return text.str();
}

std::string recipe(const LoopTruth& truth, const LoopEvaluationOptions& options) {
  std::ostringstream text;
  if (truth.pairs) {
    text << in_words(options.pairs) << "; frames within " << options.exclusion_window << " are not judged as pairs; ";
  } else {
    text << "no pairs are known, so loops are judged by their poses alone; ";
    if (options.false_radius_m) text << "a pair is false beyond " << *options.false_radius_m << " m; ";
  }
  text << pose_recipe(options);
  if (truth.pairs) {
    text << "; query recall is over queries with a pair of overlap >= " << options.min_recall_overlap
         << ", pair recall over all true pairs";
  }
  return text.str();
}

std::string_view in_words(LoopJudgement judgement) {
  switch (judgement) {
    case LoopJudgement::True:
      return "true";
    case LoopJudgement::FalsePair:
      return "false: pair";
    case LoopJudgement::FalsePose:
      return "false: pose";
    case LoopJudgement::NoReference:
      return "not judged: no reference";
    case LoopJudgement::UnclearPair:
      return "not judged: pair";
  }
  return "";
}

}  // namespace fabloop
