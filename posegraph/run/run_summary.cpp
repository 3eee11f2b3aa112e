// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/run_summary.h"

#include <ceres/version.h>

#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>
#include <string>
#include <vector>

#include "frontend/output_file.h"
#include "frontend/stage_times.h"
#include "posegraph/run/run_folder.h"
#include "posegraph/run/run_memory.h"
#include "posegraph/run/run_parameters.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

Json stage(const std::vector<double>& seconds) { return Json::parse(to_json(stage_times(seconds))); }

Json timings(const MapTimes& times) {
  return {{"read", stage(times.read_s)},           {"features", stage(times.describe_s)},    {"words", stage(times.words_s)},
          {"recognise", stage(times.recognise_s)}, {"neighbours", stage(times.neighbour_s)}, {"verify", stage(times.verify_s)},
          {"optimize", stage(times.optimize_s)}};
}

Json error_json(const std::optional<AbsoluteTrajectoryError>& error) {
  if (!error) return nullptr;
  const ErrorStatistics& statistics = error->translation_m;
  return {{"rmse_m", statistics.rmse},
          {"mean_m", statistics.mean},
          {"median_m", statistics.median},
          {"max_m", statistics.max},
          {"poses", statistics.count}};
}

Json loops_json(const Map& map) {
  const LoopCounts counts = count_loops(map);
  std::map<std::string, std::size_t> verdicts;
  std::size_t num_links = 0;
  for (const LoopEvent& event : map.events) {
    num_links += event.neighbours.size();
    for (const auto& outcome : event.hypotheses) ++verdicts[std::string(to_string(outcome.verification.verdict))];
  }
  return {{"hypotheses", counts.num_hypotheses},
          {"accepted", counts.num_accepted},
          {"accepted_with_scale", counts.num_with_scale},
          {"accepted_into_earlier_map", counts.num_into_earlier},
          {"neighbour_links", num_links},
          {"verdicts", verdicts}};
}

Json model_json(const SequenceMap& result) {
  return {{"trained_on_this_sequence", result.trained_here.has_value()}, {"features", to_string(result.model.features.kind)},
          {"max_features", result.model.features.max_features},          {"words", result.model.vocabulary.num_words()},
          {"training_images", result.model.provenance.num_images},       {"training_seed", result.model.provenance.seed}};
}

}  // namespace

void write_run_summary(const std::filesystem::path& path, const Sequence& sequence, const SequenceMap& result,
                       const MapSequenceOptions& options) {
  const Map& map = result.map;
  const RunErrors errors = run_errors(sequence, map);
  std::size_t num_points = 0;
  for (const View& view : map.views) num_points += count_points(view);
  Json summary;
  summary["sequence"] = sequence.name;
  summary["seed"] = options.seed;
  summary["frames"] = {{"images", sequence.frames.size()},
                       {"mapped", map.graph.vertices.size()},
                       {"damaged", result.num_damaged},
                       {"without_odometry", map.num_without_odometry}};
  summary["loops"] = loops_json(map);
  summary["points"] = num_points;
  summary["model"] = model_json(result);
  summary["odometry_noise"] = {{"rotation_deg_per_step", map.odometry_noise.rotation_deg},
                               {"translation_share_per_step", map.odometry_noise.translation}};
  summary["graph"] = {{"vertices", map.graph.vertices.size()},   {"edges", map.graph.edges.size()},
                      {"initial_cost", map.report.initial_cost}, {"final_cost", map.report.final_cost},
                      {"iterations", map.report.iterations},     {"termination", in_words(map.report.termination)}};
  summary["ate"] = {{"alignment", "SE(3), frames matched by time within 0.01 s"},
                    {"odometry", error_json(errors.odometry)},
                    {"online", error_json(errors.online)},
                    {"final", error_json(errors.final)}};
  summary["parameters"] = Json::parse(run_parameters_json(options, result.model.features));
  summary["memory"] = Json::parse(memory_json(map));
  summary["versions"] = {{"fabloop", FABLOOP_VERSION}, {"opencv", CV_VERSION}, {"ceres", CERES_VERSION_STRING}};
  summary["timings"] = timings(map.times);
  summary["peak_memory_mib"] = peak_memory_mib();
  OutputFile file(path);
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace fabloop
