// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

bool is_excluded(const ExclusionWindow& window, std::size_t query, std::size_t match) {
  return window && std::max(query, match) - std::min(query, match) <= *window;
}

std::string in_words(const ExclusionWindow& window) {
  if (!window) return "queries and matches are different sequences";
  return "frames within " + std::to_string(*window) + " of each other are not judged";
}

double angle_between_axes_deg(const Pose& a, const Pose& b) {
  const Eigen::Vector3d axis_a = a.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d axis_b = b.rotation * Eigen::Vector3d::UnitZ();
  return deg_from_rad(std::atan2(axis_a.cross(axis_b).norm(), axis_a.dot(axis_b)));
}

MatchTruth judge_poses(const Pose& query, const Pose& match, const PoseRules& rules) {
  const double distance_m = (query.translation - match.translation).norm();
  if (distance_m >= rules.not_judged_radius_m.value_or(rules.radius_m)) return MatchTruth::False;
  if (rules.max_angle_deg && angle_between_axes_deg(query, match) > *rules.max_angle_deg) return MatchTruth::False;
  return distance_m < rules.radius_m ? MatchTruth::True : MatchTruth::NotJudged;
}

std::string in_words(const PoseRules& rules) {
  std::ostringstream text;
  text << "a match is true when the camera centres are closer than " << rules.radius_m << " m";
  if (rules.max_angle_deg) text << " and the optical axes within " << *rules.max_angle_deg << " deg";
  text << ", else false";
  if (rules.not_judged_radius_m) text << ", but not judged from there up to " << *rules.not_judged_radius_m << " m";
  return text.str();
}

void validate(const PoseRules& rules) {
  if (!(rules.radius_m > 0.0 && std::isfinite(rules.radius_m))) throw InputError("the radius of true matches must be positive");
  if (rules.not_judged_radius_m && !(*rules.not_judged_radius_m >= rules.radius_m)) {
    throw InputError("the radius up to which matches are not judged must not be less than that of true matches");
  }
  if (rules.max_angle_deg && !(*rules.max_angle_deg >= 0.0 && *rules.max_angle_deg <= 180.0)) {
    throw InputError("the angle of true matches must be 0 to 180 degrees");
  }
}

}  // namespace

GroundTruth truth_from_matrix(LoopMatrix matrix, const ExclusionWindow& window) {
  if (window && matrix.num_queries != matrix.num_matches) {
    throw InputError("the loop matrix is " + std::to_string(matrix.num_queries) + " x " + std::to_string(matrix.num_matches) +
                     ", but within one sequence it must be square");
  }
  // Shared, because a std::function must be copyable and its copies read one matrix.
  const auto shared = std::make_shared<const LoopMatrix>(std::move(matrix));
  const auto at = [shared, window](std::size_t query, std::size_t match) {
    if (is_excluded(window, query, match)) return MatchTruth::NotJudged;
    return shared->at(query, match) ? MatchTruth::True : MatchTruth::False;
  };
  return {shared->num_queries, shared->num_matches, at, window.has_value(),
          "true matches from a loop matrix; " + in_words(window)};
}

GroundTruth truth_from_poses(std::vector<std::optional<Pose>> queries, std::vector<std::optional<Pose>> matches,
                             const ExclusionWindow& window, const PoseRules& rules) {
  validate(rules);
  const auto all_queries = std::make_shared<const std::vector<std::optional<Pose>>>(std::move(queries));
  const auto all_matches = std::make_shared<const std::vector<std::optional<Pose>>>(std::move(matches));
  const auto at = [all_queries, all_matches, window, rules](std::size_t query, std::size_t match) {
    const auto& world_from_query = (*all_queries)[query];
    const auto& world_from_match = (*all_matches)[match];
    if (is_excluded(window, query, match) || !world_from_query || !world_from_match) return MatchTruth::NotJudged;
    return judge_poses(*world_from_query, *world_from_match, rules);
  };
  return {all_queries->size(), all_matches->size(), at, window.has_value(),
          in_words(rules) + "; " + in_words(window) + ", nor are frames without a reference pose"};
}

GroundTruth truth_from_pairs(PairTruths pairs, std::vector<bool> has_reference, const ExclusionWindow& window,
                             const PairRules& rules) {
  const auto shared = std::make_shared<const PairTruths>(std::move(pairs));
  const std::size_t num_frames = has_reference.size();
  const auto at = [shared, has_reference = std::move(has_reference), window, rules](std::size_t query, std::size_t match) {
    if (is_excluded(window, query, match) || !has_reference[query] || !has_reference[match]) return MatchTruth::NotJudged;
    return judge_pair(pair_between(*shared, query, match), rules);
  };
  return {num_frames, num_frames, at, window.has_value(),
          in_words(rules) + "; " + in_words(window) + ", nor are frames without a reference pose"};
}

}  // namespace fabloop
