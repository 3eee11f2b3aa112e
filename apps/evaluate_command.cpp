// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/results_table.h"
#include "frontend/error.h"
#include "posegraph/loop_evaluation.h"
#include "posegraph/trajectory_error.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array<const char*, 3> kTrajectories = {"trajectory.tum", "trajectory_online.tum", "trajectory_odometry.tum"};

struct EvaluateArguments {
  fs::path run;
  fs::path truth;
  fs::path frames;
  bool json = false;
  bool table = false;
  bool sim3 = false;
  bool yaw = false;
  double rpe_distance_m = 100.0;
  double max_time_difference_s = 0.01;
  LoopEvaluationOptions loops;
};

fs::path reference_path(const EvaluateArguments& arguments) {
  return fs::is_directory(arguments.truth) ? arguments.truth / "reference.tum" : arguments.truth;
}

/// Times of the frames that loops.csv counts: as given, else as the run wrote them down.
std::vector<std::int64_t> frame_times(const EvaluateArguments& arguments) {
  if (!arguments.frames.empty()) return read_frame_times(arguments.frames);
  const fs::path of_run = arguments.run / "frames.csv";
  if (!fs::exists(of_run)) {
    throw InputError(of_run.string() +
                     ": is missing, so loops cannot be dated; give --frames FILE or a sequence folder as --truth");
  }
  return read_frame_times(of_run);
}

LoopTruth read_truth(const EvaluateArguments& arguments, const Trajectory& reference) {
  const bool is_folder = fs::is_directory(arguments.truth);
  if (is_folder && arguments.frames.empty()) return read_loop_truth(arguments.truth, arguments.max_time_difference_s);
  const auto times_ns = frame_times(arguments);
  LoopTruth truth;
  truth.world_from_camera = reference_poses(times_ns, reference, arguments.max_time_difference_s);
  if (is_folder && fs::exists(arguments.truth / "pairs.csv")) truth.pairs = read_pairs(arguments.truth / "pairs.csv");
  return truth;
}

ordered_json to_json(const ErrorStatistics& errors) {
  return {{"rmse", errors.rmse}, {"mean", errors.mean}, {"median", errors.median}, {"max", errors.max}, {"count", errors.count}};
}

ordered_json to_json(const std::optional<RelativePoseError>& rpe) {
  if (!rpe) return nullptr;
  return {{"translation_m", to_json(rpe->translation_m)}, {"rotation_deg", to_json(rpe->rotation_deg)}};
}

ordered_json judge_trajectory(const EvaluateArguments& arguments, const fs::path& path, const Trajectory& reference) {
  const Trajectory estimate = read_tum(path);
  TrajectoryErrorOptions options;
  options.alignment = arguments.sim3 ? Alignment::Sim3 : arguments.yaw ? Alignment::Yaw : Alignment::Se3;
  options.max_time_difference_s = arguments.max_time_difference_s;
  const auto ate = absolute_trajectory_error(estimate, reference, options);
  ordered_json result;
  result["poses"] = estimate.size();
  result["ate_m"] = ate ? to_json(ate->translation_m) : ordered_json(nullptr);
  if (ate && arguments.sim3) result["scale"] = ate->reference_from_estimate.scale;
  result["rpe_per_step"] = to_json(relative_pose_error(estimate, reference, options));
  options.segment_length_m = arguments.rpe_distance_m;
  result["rpe_over_distance"] = to_json(relative_pose_error(estimate, reference, options));
  result["rpe_distance_m"] = arguments.rpe_distance_m;
  result["alignment"] = arguments.sim3 ? "Sim(3)" : arguments.yaw ? "yaw and translation" : "SE(3)";
  std::ostringstream evo;
  evo << "evo_ape tum " << reference_path(arguments).string() << ' ' << path.string() << (arguments.sim3 ? " -as" : " -a");
  if (arguments.max_time_difference_s != 0.01) evo << " --t_max_diff " << arguments.max_time_difference_s;
  // evo has no alignment by yaw.
  if (!arguments.yaw) result["repeat_with"] = evo.str();
  return result;
}

ordered_json judge_loops(const EvaluateArguments& arguments, const LoopTruth& truth) {
  const LoopEvaluation evaluation = evaluate_loops(read_loops(arguments.run / "loops.csv"), truth, arguments.loops);
  ordered_json result;
  result["hypotheses"] = evaluation.num_hypotheses;
  result["accepted"] = evaluation.num_accepted;
  result["true"] = evaluation.num_true;
  result["false"] = evaluation.num_false;
  result["unjudged"] = evaluation.num_unjudged;
  result["with_scale"] = evaluation.num_with_scale;
  result["precision"] = evaluation.precision ? ordered_json(*evaluation.precision) : ordered_json(nullptr);
  result["query_recall"] = evaluation.query_recall ? ordered_json(*evaluation.query_recall) : ordered_json(nullptr);
  result["pair_recall"] = evaluation.pair_recall ? ordered_json(*evaluation.pair_recall) : ordered_json(nullptr);
  result["false_loops"] = ordered_json::array();
  for (const JudgedLoop& loop : evaluation.loops) {
    if (loop.judgement != LoopJudgement::FalsePair && loop.judgement != LoopJudgement::FalsePose) continue;
    result["false_loops"].push_back({{"query", loop.query},
                                     {"match", loop.match},
                                     {"why", in_words(loop.judgement)},
                                     {"rotation_error_deg", loop.rotation_error_deg},
                                     {"translation_error_m", loop.translation_error_m},
                                     {"direction_error_deg", loop.direction_error_deg}});
  }
  result["recipe"] = recipe(truth, arguments.loops);
  return result;
}

void print_rpe(const ordered_json& rpe, const std::string& name) {
  if (rpe.is_null()) return;
  std::cout << "  RPE " << name << "  rmse " << rpe["translation_m"]["rmse"].get<double>() << " m, "
            << rpe["rotation_deg"]["rmse"].get<double>() << " deg (" << rpe["translation_m"]["count"] << " stretches)\n";
}

void print_trajectory(const std::string& name, const ordered_json& result) {
  std::cout << name << '\n';
  const ordered_json& ate = result["ate_m"];
  if (ate.is_null()) {
    std::cout << "  ATE  not defined: fewer than 3 poses at times of the reference, or all in one place\n";
    return;
  }
  std::cout << "  ATE  rmse " << ate["rmse"].get<double>() << " m, mean " << ate["mean"].get<double>() << ", median "
            << ate["median"].get<double>() << ", max " << ate["max"].get<double>() << " (" << ate["count"] << " of "
            << result["poses"] << " poses, aligned by " << result["alignment"].get<std::string>();
  if (result.contains("scale")) std::cout << ", scale " << result["scale"].get<double>();
  std::cout << ")\n";
  print_rpe(result["rpe_per_step"], "per step");
  std::ostringstream distance;
  distance << "per " << result["rpe_distance_m"].get<double>() << " m";
  print_rpe(result["rpe_over_distance"], distance.str());
  std::cout << "  repeat with: " << result["repeat_with"].get<std::string>() << '\n';
}

void print_loops(const ordered_json& result) {
  std::cout << "loops.csv\n  accepted " << result["accepted"] << " of " << result["hypotheses"] << " hypotheses ("
            << result["with_scale"] << " with scale): " << result["true"] << " true, " << result["false"] << " false, "
            << result["unjudged"] << " not judged\n";
  if (!result["precision"].is_null()) std::cout << "  precision " << result["precision"].get<double>() << '\n';
  if (!result["query_recall"].is_null()) std::cout << "  query recall " << result["query_recall"].get<double>() << '\n';
  if (!result["pair_recall"].is_null()) std::cout << "  pair recall " << result["pair_recall"].get<double>() << '\n';
  for (const ordered_json& loop : result["false_loops"]) {
    std::cout << "  " << loop["query"] << " - " << loop["match"] << ' ' << loop["why"].get<std::string>() << ", "
              << loop["rotation_error_deg"].get<double>() << " deg, " << loop["translation_error_m"].get<double>() << " m\n";
  }
  std::cout << "  recipe: " << result["recipe"].get<std::string>() << '\n';
}

void run_evaluate(const EvaluateArguments& arguments) {
  if (!fs::is_directory(arguments.run))
    throw InputError(arguments.run.string() + ": is not a folder; give the folder that a run wrote");
  const Trajectory reference = read_tum(reference_path(arguments));
  ordered_json result = {
      {"run", arguments.run.string()}, {"truth", arguments.truth.string()}, {"trajectories", ordered_json::object()}};
  for (const char* name : kTrajectories) {
    const fs::path path = arguments.run / name;
    if (fs::exists(path)) result["trajectories"][name] = judge_trajectory(arguments, path, reference);
  }
  const bool has_loops = fs::exists(arguments.run / "loops.csv");
  if (has_loops) result["loops"] = judge_loops(arguments, read_truth(arguments, reference));
  if (!has_loops && result["trajectories"].empty()) {
    throw InputError(arguments.run.string() + ": has neither trajectory.tum nor loops.csv; give the folder that a run wrote");
  }
  if (arguments.json) {
    std::cout << result.dump(2) << '\n';
    return;
  }
  if (arguments.table) {
    std::cout << results_head() << results_row(arguments.run, result);
    return;
  }
  std::cout << std::setprecision(4);
  for (const auto& [name, trajectory] : result["trajectories"].items()) print_trajectory(name, trajectory);
  if (has_loops) print_loops(result["loops"]);
}

}  // namespace

void add_evaluate_command(CLI::App& program) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = program.add_subcommand("evaluate", "Judge a run's trajectories and loops against a reference");
  command->add_option("RUN", arguments->run, "folder that a run wrote")->required();
  command
      ->add_option("--truth", arguments->truth,
                   "sequence folder (reference.tum, frames.csv, pairs.csv), or a reference in TUM format")
      ->required();
  command->add_option(
      "--frames", arguments->frames,
      "times of the frames (lines 'filename,timestamp_s'); default: those of the sequence folder, else of the run");
  command
      ->add_option("--height", arguments->loops.height_above_ground_m, "height above ground, metres; sets what a wrong loop is")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rpe-distance", arguments->rpe_distance_m, "length of the stretches for the relative pose error, metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", arguments->max_time_difference_s, "largest difference between matched times, seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--sim3", arguments->sim3, "align with scale too, for trajectories that do not know theirs");
  command->add_flag("--yaw", arguments->yaw, "align heading and position only, for trajectories that know where down is (z up)")
      ->excludes("--sim3");
  command->add_flag("--json", arguments->json, "print one JSON object");
  command->add_flag("--table", arguments->table,
                    "print a table row with the run's counts, errors and seconds a frame (Markdown)");
  command->callback([arguments] { run_evaluate(*arguments); });
}

}  // namespace fabloop::apps
