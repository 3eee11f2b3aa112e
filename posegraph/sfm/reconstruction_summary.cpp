// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruction_summary.h"

#include <nlohmann/json.hpp>
#include <string>

#include "frontend/features/feature_settings.h"
#include "frontend/output_file.h"
#include "frontend/sequence/sequence_trajectories.h"
#include "frontend/stage_times.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/sfm/reconstruction_folder.h"
#include "posegraph/sfm/reconstruction_graph.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

Json left_out_json(const Reconstructed& result) {
  Json list = Json::array();
  for (const LeftOutFrame& frame : result.left_out) list.push_back({{"frame", frame.frame}, {"why", frame.why}});
  return list;
}

Json loops_json(const Reconstructed& result) {
  std::size_t num_hypotheses = 0;
  std::size_t num_accepted = 0;
  for (const LoopEvent& event : reconstruction_loops(result)) {
    num_hypotheses += event.hypotheses.size();
    for (const auto& outcome : event.hypotheses) num_accepted += outcome.verification.verdict == Verdict::Accepted;
  }
  const bool has_scale = result.reconstruction.unit == LengthUnit::Metres;
  return {{"hypotheses", num_hypotheses}, {"accepted", num_accepted}, {"accepted_with_scale", has_scale ? num_accepted : 0}};
}

Json camera_json(const Reconstructed& result) {
  const Camera& camera = result.reconstruction.cameras.front();
  const CameraCheck& check = result.camera_check;
  return {{"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", camera.distortion},
          {"refined", result.camera_was_refined},
          {"best_focal_over_given", check.best_focal_factor},
          {"focal_relative_sigma", check.relative_sigma},
          {"focal_is_determined", check.is_determined},
          {"focal_is_contradicted", check.is_contradicted}};
}

Json shutter_json(const Reconstructed& result) {
  const RollingShutterCheck& check = result.rolling_shutter_check;
  Json json = {{"modelled_readout_s", nullptr}, {"readout_s", nullptr}};
  if (result.modelled_readout) json["modelled_readout_s"] = result.modelled_readout->readout_s;
  if (!check.is_known) return json;
  json["readout_s"] = check.readout_s;
  json["readout_sigma_s"] = check.sigma_s;
  json["shift_px"] = check.shift_px();
  json["shift_sigma_px"] = check.shift_sigma_px();
  json["is_certain"] = check.is_certain;
  return json;
}

Json georeference_json(const Reconstructed& result, const ReconstructOptions& options) {
  if (!result.georeference.found) return {{"found", false}, {"why_not", result.georeference.why_not}};
  const Georeference& found = *result.georeference.found;
  const char* use = options.position_use == PositionUse::Witness ? "witness"
                    : options.position_use == PositionUse::Align ? "align"
                                                                 : "prior";
  Json json = {{"found", true},        {"use", use},           {"positions", found.num_positions}, {"inliers", found.num_inliers},
               {"scale", found.scale}, {"rms_m", found.rms_m}, {"median_m", found.median_m}};
  if (const auto& origin = result.reconstruction.origin) {
    json["origin"] = {
        {"latitude_deg", origin->latitude_deg}, {"longitude_deg", origin->longitude_deg}, {"altitude_m", origin->altitude_m}};
  }
  return json;
}

/// Limits that a pair or a view must pass, and what decides how much is tried.
Json parameters_json(const ReconstructOptions& options) {
  return {{"candidates",
           {{"num_neighbours", options.candidates.num_neighbours},
            {"num_hypotheses", options.candidates.num_hypotheses},
            {"num_nearest", options.candidates.num_nearest}}},
          {"pairs",
           {{"min_inliers", options.view_graph.min_inliers},
            {"max_error_px", options.view_graph.max_error_px},
            {"max_log10_false_alarms", options.view_graph.max_log10_false_alarms},
            {"min_shared_points", ReconstructionGraphOptions{}.min_shared_points}}},
          {"views",
           {{"min_inliers", options.growth.resection.min_inliers},
            {"min_inlier_share", options.growth.resection.min_inlier_share},
            {"max_error_px", options.max_error_px},
            {"min_parallax_deg", options.growth.triangulation.min_parallax_deg}}},
          {"features", Json::parse(feature_options_json(options.features))}};
}

Json error_json(const Sequence& sequence, const Reconstruction& map) {
  TrajectoryErrorOptions options;
  options.alignment = map.unit == LengthUnit::Metres ? Alignment::Se3 : Alignment::Sim3;
  const auto error = absolute_trajectory_error(trajectory_of(map), reference_trajectory(sequence), options);
  Json json = {{"alignment", options.alignment == Alignment::Sim3 ? "Sim(3), frames matched by time within 0.01 s"
                                                                  : "SE(3), frames matched by time within 0.01 s"},
               {"odometry", nullptr},
               {"online", nullptr},
               {"final", nullptr}};
  if (error) {
    const ErrorStatistics& statistics = error->translation_m;
    json["final"] = {{"rmse_m", statistics.rmse},
                     {"mean_m", statistics.mean},
                     {"median_m", statistics.median},
                     {"max_m", statistics.max},
                     {"poses", statistics.count}};
  }
  return json;
}

}  // namespace

void write_reconstruction_summary(const std::filesystem::path& path, const Sequence& sequence, const Reconstructed& result,
                                  const ReconstructOptions& options) {
  const Reconstruction& map = result.reconstruction;
  Json summary;
  summary["sequence"] = sequence.name;
  summary["method"] = "structure from motion";
  summary["seed"] = options.seed;
  summary["unit"] = map.unit == LengthUnit::Metres ? "metres" : "arbitrary";
  summary["frames"] = {{"images", sequence.frames.size()},
                       {"mapped", map.images.size()},
                       {"left_out", left_out_json(result)},
                       {"other_parts", result.other_parts}};
  summary["pairs"] = {{"candidates", result.num_candidate_pairs}, {"proven", result.pairs.size()}};
  summary["loops"] = loops_json(result);
  summary["points"] = map.points.size();
  summary["sightings"] = result.num_sightings;
  summary["merged_points"] = result.num_merged_points;
  summary["mean_reprojection_error_px"] = result.mean_error_px;
  summary["feature_pixel_size"] = result.feature_pixel_size;
  summary["camera"] = camera_json(result);
  summary["rolling_shutter"] = shutter_json(result);
  summary["georeference"] = georeference_json(result, options);
  summary["ate"] = error_json(sequence, map);
  summary["parameters"] = parameters_json(options);
  summary["versions"] = {{"fabloop", FABLOOP_VERSION}};
  for (const StageTime& time : result.times) summary["timings"][time.stage] = Json::parse(to_json(stage_times({time.seconds})));
  OutputFile file(path);
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace fabloop
