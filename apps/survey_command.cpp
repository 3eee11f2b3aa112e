// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/evaluation/pair_survey.h"
#include "posegraph/evaluation/pair_survey_csv.h"

namespace fabloop::apps {
namespace {

struct SurveyArguments {
  std::vector<std::string> sequences;
  std::vector<double> heights_m;
  std::string pairs_csv;
  std::string only_csv;
  FeatureArguments features;
  PairSurveyOptions options;
};

std::filesystem::path odometry_in(const std::filesystem::path& folder) {
  const auto path = folder / "odometry.tum";
  return std::filesystem::exists(path) ? path : std::filesystem::path{};
}

std::string share(const OverlapRecall& recall) {
  if (recall.num_pairs == 0) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << static_cast<double>(recall.num_found) / static_cast<double>(recall.num_pairs)
       << " of " << recall.num_pairs;
  return text.str();
}

void print_table(std::ostream& out, const std::vector<SurveySummary>& summaries, const std::vector<Sequence>& sequences) {
  out << "| images of | and of | pairs | accepted | false | not judged | found, overlap >= 0.3 | found, overlap 0.1 to 0.3 |\n"
         "|---|---|---|---|---|---|---|---|\n";
  for (const SurveySummary& summary : summaries) {
    const bool across = summary.query_sequence != summary.match_sequence;
    out << "| " << sequences[summary.query_sequence].name << " | " << (across ? sequences[summary.match_sequence].name : "itself")
        << " | " << summary.num_pairs << " | " << summary.num_accepted << " | " << summary.num_false << " | "
        << summary.num_unjudged << " | " << share(summary.wide) << " | " << share(summary.narrow) << " |\n";
  }
}

void run_survey(const SurveyArguments& arguments, const CommonOptions& common) {
  if (!arguments.heights_m.empty() && arguments.heights_m.size() != arguments.sequences.size()) {
    throw InputError("--height: give one height above ground for each of the " + std::to_string(arguments.sequences.size()) +
                     " sequences");
  }
  std::vector<Sequence> sequences;
  std::vector<LoopTruth> truths;
  std::vector<LoopEvaluationOptions> evaluations;
  for (std::size_t s = 0; s < arguments.sequences.size(); ++s) {
    const std::filesystem::path folder = arguments.sequences[s];
    truths.push_back(read_loop_truth(folder));
    sequences.push_back(read_sequence(folder, {.odometry = odometry_in(folder), .warn = make_warn(common)}));
    LoopEvaluationOptions evaluation;
    if (!arguments.heights_m.empty()) evaluation.height_above_ground_m = arguments.heights_m[s];
    evaluations.push_back(evaluation);
  }
  PairSurveyOptions options = arguments.options;
  options.features = asked_features(arguments.features);
  options.num_threads = common.num_threads;
  options.warn = make_warn(common);
  options.progress = make_progress(common);
  if (!arguments.pairs_csv.empty()) require_distinct_names(sequences);
  if (!arguments.only_csv.empty()) options.only = read_asked_pairs(arguments.only_csv, sequences);
  const std::vector<SurveyedPair> pairs = survey_pairs(sequences, options);
  if (!arguments.pairs_csv.empty()) write_surveyed_pairs(arguments.pairs_csv, pairs, sequences, truths, evaluations);
  print_table(std::cout, summarise_survey(pairs, truths, evaluations), sequences);
}

}  // namespace

void add_survey_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<SurveyArguments>();
  CLI::App* command = program.add_subcommand(
      "survey", "Verify every pair of images in and across sequences with ground truth: what geometry alone lets through");
  command->add_option("SEQUENCE", arguments->sequences, "folders with images, reference.tum, pairs.csv; all of different places")
      ->required();
  command->add_option("--height", arguments->heights_m, "metres above ground, one a sequence: 10 % more is a false pose");
  command->add_option("--pairs", arguments->pairs_csv, "CSV file to write every pair and its figures to");
  command
      ->add_option("--only", arguments->only_csv, "verify only the pairs of this CSV file, as --pairs writes it, or lines of it")
      ->check(CLI::ExistingFile);
  VerifierOptions& verifier = arguments->options.verifier;
  command->add_option("--min-inliers", verifier.min_inliers, "least inliers of a pair")->capture_default_str();
  command
      ->add_option("--max-error-px", verifier.max_error_px,
                   "largest epipolar error of an inlier, in pixels of the image as its features were found")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--max-iterations", verifier.max_iterations, "samples that RANSAC may draw: time spent on false pairs")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", verifier.seed, "another number: other samples")->capture_default_str();
  add_feature_arguments(command, arguments->features, "");
  command->callback([arguments, &common] { run_survey(*arguments, common); });
}

}  // namespace fabloop::apps
