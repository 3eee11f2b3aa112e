// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"
#include "data/world_writer.h"
#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/map_sequence.h"
#include "posegraph/run/run_folder.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

struct DemoArguments {
  std::string out = "fabloop-demo";
  double length_m = 440;
  std::uint64_t seed = 1;
  bool overwrite = false;
};

/// A short flight has little time to drift: twice a real odometry's error shows what the loops are good for.
constexpr double kDriftFactor = 2.0;

SyntheticFlightOptions flight_options(const DemoArguments& arguments, const CommonOptions& common) {
  SyntheticFlightOptions options;
  options.seed = arguments.seed;
  options.flight.length_m = arguments.length_m;
  options.drift.heading_drift_deg_per_100m *= kDriftFactor;
  options.drift.rotation_noise_deg *= kDriftFactor;
  options.num_threads = common.num_threads;
  options.progress = make_progress(common);
  return options;
}

void print_judgement(const fs::path& sequence_folder, const fs::path& run_folder, double height_m) {
  LoopEvaluationOptions options;
  options.height_above_ground_m = height_m;
  const LoopEvaluation judged = evaluate_loops(read_loops(run_folder / "loops.csv"), read_loop_truth(sequence_folder), options);
  std::cout << "against truth: " << judged.num_true << " loops true, " << judged.num_false << " false";
  if (judged.precision) std::cout << ": precision " << std::setprecision(3) << *judged.precision;
  if (judged.query_recall)
    std::cout << ", " << std::lround(100 * *judged.query_recall) << " % of the frames with a revisit found one";
  std::cout << '\n';
}

void run_demo(const DemoArguments& arguments, const CommonOptions& common) {
  const auto start = std::chrono::steady_clock::now();
  OutputFolder folder(arguments.out, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  const fs::path sequence_folder = folder.part_path() / "sequence";
  const fs::path run_folder = folder.part_path() / "run";

  const SyntheticFlightOptions flight = flight_options(arguments, common);
  std::cout << "1. a low flight of " << std::lround(arguments.length_m)
            << " m over a synthetic meadow, with an odometry that drifts\n"
            << std::flush;
  write_synthetic_flight(sequence_folder, flight);
  SequenceOptions sequence_options;
  sequence_options.odometry = sequence_folder / "odometry.tum";
  sequence_options.warn = make_warn(common);
  const Sequence sequence = read_sequence(sequence_folder, sequence_options);

  std::cout << "2. visual words learnt from the images; then image by image: where could this be? prove it; bend the map\n"
            << std::flush;
  MapSequenceOptions options;
  options.seed = arguments.seed;
  options.num_threads = common.num_threads;
  options.progress = make_progress(common);
  options.warn = make_warn(common);
  const SequenceMap result = map_sequence(sequence, std::nullopt, options);
  write_run_folder(run_folder, sequence, result, options);

  std::cout << "3. what came of it\n";
  print_judgement(sequence_folder, run_folder, flight.flight.mean_height_m);
  folder.commit();
  print_run_report(std::cout, sequence, result, (fs::path(arguments.out) / "run").string());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::cout << "the same again: fabloop map " << (fs::path(arguments.out) / "sequence").string() << " --odometry "
            << (fs::path(arguments.out) / "sequence" / "odometry.tum").string() << " --out DIR   (" << std::lround(seconds)
            << " s)\n";
}

}  // namespace

void add_demo_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<DemoArguments>();
  CLI::App* command =
      program.add_subcommand("demo", "Render a synthetic flight, map it, and judge the result: under two minutes");
  command->add_option("--out", arguments->out, "folder for the sequence and the run")->capture_default_str();
  command->add_option("--length", arguments->length_m, "length of the flight, metres")
      ->check(CLI::Range(200.0, 5000.0))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "another number: another world and flight")->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "replace the folder if it exists");
  command->callback([arguments, &common] { run_demo(*arguments, common); });
}

}  // namespace fabloop::apps
