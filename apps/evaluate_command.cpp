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
#include "apps/evaluation_report.h"
#include "apps/results_table.h"
#include "apps/run_files.h"
#include "apps/run_truth.h"
#include "apps/stage_report.h"
#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/stage_evaluation.h"
#include "posegraph/evaluation/stage_trajectories.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/run/ledger_table.h"
#include "posegraph/sfm/point_error.h"
#include "posegraph/sfm/run_reader.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array<const char*, 3> kTrajectories = {"trajectory.tum", "trajectory_online.tum", "trajectory_odometry.tum"};

struct EvaluateArguments {
  TruthArguments truth;
  fs::path tables;
  bool json = false;
  bool table = false;
  bool sim3 = false;
  bool yaw = false;
  bool overwrite = false;
  double max_angle_deg = 0.0;
  std::optional<double> false_radius_m;
  double rpe_distance_m = 100.0;
  LoopEvaluationOptions loops;
  StageOptions stages;
};

ordered_json to_json(const ErrorStatistics& errors) {
  return {{"rmse", errors.rmse}, {"mean", errors.mean}, {"median", errors.median}, {"max", errors.max}, {"count", errors.count}};
}

ordered_json to_json(const std::optional<RelativePoseError>& rpe) {
  if (!rpe) return nullptr;
  return {{"translation_m", to_json(rpe->translation_m)}, {"rotation_deg", to_json(rpe->rotation_deg)}};
}

TrajectoryErrorOptions error_options(const EvaluateArguments& arguments) {
  TrajectoryErrorOptions options;
  options.alignment = arguments.sim3 ? Alignment::Sim3 : arguments.yaw ? Alignment::Yaw : Alignment::Se3;
  options.max_time_difference_s = arguments.truth.places.max_time_difference_s;
  return options;
}

ordered_json judge_trajectory(const EvaluateArguments& arguments, const fs::path& path, const Trajectory& reference) {
  const Trajectory estimate = read_tum(path);
  TrajectoryErrorOptions options = error_options(arguments);
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
  evo << "evo_ape tum " << reference_path(arguments.truth)->string() << ' ' << path.string() << (arguments.sim3 ? " -as" : " -a");
  if (options.max_time_difference_s != 0.01) evo << " --t_max_diff " << options.max_time_difference_s;
  // evo has no alignment by yaw.
  if (!arguments.yaw) result["repeat_with"] = evo.str();
  return result;
}

/// How far the points of a map from images alone lie from where the reference's cameras see them; null for other runs.
ordered_json judge_points(const EvaluateArguments& arguments, const Trajectory& reference) {
  const auto map = read_reconstruction(arguments.truth.run);
  if (!map || reference.empty()) return nullptr;
  const auto error = point_error(*map, reference, error_options(arguments));
  if (!error) return nullptr;
  return {{"across_m", to_json(error->across_m)}, {"height_m", to_json(error->height_m)}};
}

/// The final error as a share of the odometry's; null without both, and where they are of different frames: the error of a short
/// stretch, aligned by itself, says nothing of the whole.
ordered_json error_left(const ordered_json& trajectories) {
  for (const char* name : {"trajectory.tum", "trajectory_odometry.tum"}) {
    if (!trajectories.contains(name) || trajectories[name]["ate_m"].is_null()) return nullptr;
  }
  if (trajectories["trajectory.tum"]["poses"] != trajectories["trajectory_odometry.tum"]["poses"]) return nullptr;
  const double before = trajectories["trajectory_odometry.tum"]["ate_m"]["rmse"].get<double>();
  if (!(before > 0.0)) return nullptr;
  return trajectories["trajectory.tum"]["ate_m"]["rmse"].get<double>() / before;
}

ordered_json judge_loops(const EvaluateArguments& arguments, const LoopTruth& truth) {
  const LoopEvaluation evaluation = evaluate_loops(read_loops(arguments.truth.run / "loops.csv"), truth, arguments.loops);
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

/// What the map's error would be without some of the stages.
ordered_json judge_without_stages(const EvaluateArguments& arguments, const RunKind& kind, const RunTruth& truth,
                                  const LedgerTable& ledger) {
  ordered_json result = ordered_json::array();
  const fs::path graph = arguments.truth.run / "graph.g2o";
  if (!fs::exists(graph) || truth.reference.empty() || kind.is_from_images) return result;
  for (const StageTrajectory& without : solve_without_stages(read_g2o(graph), ledger, truth.frame_times_ns)) {
    const auto ate = absolute_trajectory_error(without.trajectory, truth.reference, error_options(arguments));
    result.push_back({{"name", without.name},
                      {"note", without.note},
                      {"loops", without.num_loops},
                      {"ate_m", ate ? to_json(ate->translation_m) : ordered_json(nullptr)}});
  }
  return result;
}

void write_tables(const EvaluateArguments& arguments, const StageEvaluation& stages) {
  OutputFolder folder(arguments.tables, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  write_stage_tables(folder.part_path(), stages);
  folder.commit();
}

void run_evaluate(const EvaluateArguments& arguments) {
  const fs::path& run = arguments.truth.run;
  if (!fs::is_directory(run)) throw InputError(run.string() + ": is not a folder; give the folder that a run wrote");
  const auto reference = reference_path(arguments.truth);
  ordered_json result = {
      {"run", run.string()}, {"truth", arguments.truth.truth.string()}, {"trajectories", ordered_json::object()}};
  const Trajectory reference_trajectory = reference ? read_tum(*reference) : Trajectory{};
  for (const char* name : kTrajectories) {
    if (!reference || !fs::exists(run / name)) continue;
    result["trajectories"][name] = judge_trajectory(arguments, run / name, reference_trajectory);
  }
  result["error_left"] = error_left(result["trajectories"]);
  result["points"] = judge_points(arguments, reference_trajectory);
  const bool has_loops = fs::exists(run / "loops.csv");
  if (!has_loops && result["trajectories"].empty()) {
    throw InputError(run.string() + ": has neither trajectory.tum nor loops.csv; give the folder that a run wrote");
  }
  std::optional<StageEvaluation> stages;
  if (has_loops) {
    const RunTruth truth = read_run_truth(arguments.truth);
    result["loops"] = judge_loops(arguments, truth.loops);
    if (!arguments.table) {
      const LedgerTable ledger = read_ledger(run / "loops.csv");
      const RunKind kind = run_kind(find_summary(run));
      stages = evaluate_stages(judge_run(ledger, truth.places, truth.loops, arguments.loops), kind, arguments.stages);
      result["stages"] = stages_json(*stages);
      result["without_stages"] = judge_without_stages(arguments, kind, truth, ledger);
    }
  }
  if (stages && !arguments.tables.empty()) write_tables(arguments, *stages);
  if (arguments.json) {
    std::cout << result.dump(2) << '\n';
    return;
  }
  if (arguments.table) {
    std::cout << results_head() << results_row(run, result);
    return;
  }
  std::cout << std::setprecision(4);
  for (const auto& [name, trajectory] : result["trajectories"].items()) print_trajectory(std::cout, name, trajectory);
  if (!result["points"].is_null()) print_points(std::cout, result["points"]);
  if (!result["error_left"].is_null()) {
    std::cout << "ATE of trajectory.tum over that of trajectory_odometry.tum: " << result["error_left"].get<double>() << '\n';
  }
  if (has_loops) print_loops(std::cout, result["loops"]);
  if (!stages) return;
  print_stages(std::cout, *stages);
  print_without_stages(std::cout, result["without_stages"]);
}

void add_truth_options(CLI::App* command, EvaluateArguments& arguments) {
  command->add_option("RUN", arguments.truth.run, "folder that a run wrote")->required();
  command
      ->add_option("--truth", arguments.truth.truth,
                   "sequence folder (reference.tum, frames.csv, pairs.csv), a reference in TUM format, or a loop matrix")
      ->required();
  command->add_option(
      "--frames", arguments.truth.frames,
      "times of the frames (lines 'filename,timestamp_s'); default: those of the sequence folder, else of the run");
  command
      ->add_option("--height", arguments.loops.height_above_ground_m,
                   "height above ground, metres; sets what a wrong loop is, and --false-radius")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--radius", arguments.truth.places.poses.radius_m, "without pairs.csv: camera centres nearer show one place")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option(
          "--false-radius", arguments.false_radius_m,
          "without pairs.csv: camera centres further apart than this show different places, those between are not judged "
          "(default: three times the height)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--max-angle", arguments.max_angle_deg,
                   "without pairs.csv: and optical axes within this angle, degrees (default: any)")
      ->check(CLI::Range(0.0, 180.0));
  command->add_option("--window", arguments.truth.places.exclusion_window, "frames no further apart are neither right nor wrong")
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", arguments.truth.places.max_time_difference_s,
                   "largest difference between matched times, seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void add_output_options(CLI::App* command, EvaluateArguments& arguments) {
  command->add_option("--rpe-distance", arguments.rpe_distance_m, "length of the stretches for the relative pose error, metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--sim3", arguments.sim3, "align with scale too, for trajectories that do not know theirs");
  command->add_flag("--yaw", arguments.yaw, "align heading and position only, for trajectories that know where down is (z up)")
      ->excludes("--sim3");
  command->add_option("--resamples", arguments.stages.bootstrap.num_resamples, "of the bootstrap; 0: no confidence intervals")
      ->capture_default_str();
  command->add_option("--seed", arguments.stages.bootstrap.seed, "another number: other resamples")->capture_default_str();
  command->add_option("--tables", arguments.tables, "folder to write stages.csv, precision_recall.csv and calibration.csv to");
  command->add_flag("--overwrite", arguments.overwrite, "replace that folder if it exists");
  command->add_flag("--json", arguments.json, "print one JSON object");
  command->add_flag("--table", arguments.table, "print a table row with the run's counts, errors and seconds a frame (Markdown)");
}

}  // namespace

void add_evaluate_command(CLI::App& program) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = program.add_subcommand("evaluate", "Judge a run's trajectories, loops and stages against a reference");
  add_truth_options(command, *arguments);
  add_output_options(command, *arguments);
  command->callback([arguments] {
    if (arguments->max_angle_deg > 0.0) arguments->truth.places.poses.max_angle_deg = arguments->max_angle_deg;
    set_false_radius(arguments->truth, arguments->loops, arguments->false_radius_m);
    arguments->loops.exclusion_window = arguments->truth.places.exclusion_window;
    run_evaluate(*arguments);
  });
}

}  // namespace fabloop::apps
