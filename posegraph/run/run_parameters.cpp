// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/run_parameters.h"

#include <nlohmann/json.hpp>

#include "frontend/error.h"
#include "frontend/features/feature_settings.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

/// Calls `visit(name, value)` for each limit that a gate compares a figure with: the one place where they are listed.
template <typename Options, typename Visitor>
void for_each_limit(Options& options, Visitor&& visit) {
  visit("max_ratio", options.matching.max_ratio);
  visit("min_matches", options.min_matches);
  visit("min_inliers", options.min_inliers);
  visit("max_error_px", options.max_error_px);
  visit("max_point_error_px", options.max_point_error_px);
  visit("max_log10_false_alarms", options.max_log10_false_alarms);
  visit("min_inlier_area", options.min_inlier_area);
  visit("max_second_support", options.max_second_support);
  visit("max_rotation_share", options.max_rotation_share);
  visit("min_point_inlier_ratio", options.min_point_inlier_ratio);
  visit("min_ray_inlier_ratio", options.min_ray_inlier_ratio);
  visit("max_rotation_sigma", options.max_rotation_sigma);
  visit("max_translation_sigma", options.max_translation_sigma);
  visit("max_direction_sigma", options.max_direction_sigma);
  visit("max_distance_sigma", options.max_distance_sigma);
  visit("min_probability", options.min_probability);
  visit("ransac_confidence", options.confidence);
  visit("max_iterations", options.max_iterations);
}

Json parsed(std::string_view json) {
  Json parameters = Json::parse(json, nullptr, false);
  if (!parameters.is_object()) throw InputError("summary.json: 'parameters' is no object; give the folder that a run wrote");
  return parameters;
}

}  // namespace

std::string run_parameters_json(const MapSequenceOptions& options, const FeatureOptions& features) {
  const LoopCloserOptions& loops = options.mapper.loops;
  Json verifier = Json::object();
  for_each_limit(loops.verifier, [&](const char* name, const auto& value) { verifier[name] = value; });
  verifier["second_look_features"] = loops.verifier.second_look.num_first_features;
  verifier["guided"] = loops.verifier.guided;
  verifier["match_by"] = loops.verifier.match_by == MatchBy::Words ? "words" : "features";
  verifier["keyframe_windows"] = loops.window_size;
  return Json{{"hypotheses",
               {{"max_hypotheses", loops.hypotheses.max_hypotheses},
                {"num_recent_excluded", loops.hypotheses.num_recent_excluded},
                {"min_probability", loops.hypotheses.min_probability},
                {"new_place", loops.recognizer.new_place == NewPlaceModel::Sampled ? "sampled" : "mean-field"}}},
              {"verifier", verifier},
              {"consistency",
               {{"num_required", loops.consistency.num_required},
                {"max_missed", loops.consistency.max_missed},
                {"p_agree", loops.consistency.p_agree}}},
              {"back_end",
               {{"robust_probability", options.mapper.optimize.robust_probability},
                {"solve_every", options.mapper.solve_every},
                {"max_loop_surprise", options.mapper.max_loop_surprise}}},
              {"features", Json::parse(feature_options_json(features))}}
      .dump();
}

VerifierOptions verifier_options_from_parameters(std::string_view json) {
  const Json parameters = parsed(json);
  VerifierOptions options;
  if (!parameters.contains("verifier")) return options;
  const Json& limits = parameters["verifier"];
  for_each_limit(options, [&](const char* name, auto& value) {
    if (limits.contains(name) && limits[name].is_number()) limits[name].get_to(value);
  });
  return options;
}

FeatureOptions features_from_parameters(std::string_view json) {
  const Json parameters = parsed(json);
  if (!parameters.contains("features")) {
    throw InputError("summary.json: does not say which features the run used; map the sequence again with this version");
  }
  return feature_options_from_json(parameters["features"].dump());
}

}  // namespace fabloop
