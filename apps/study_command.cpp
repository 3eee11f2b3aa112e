// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/robust_arguments.h"
#include "frontend/error.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/robust/false_loop_study.h"

namespace fabloop::apps {
namespace {

struct StudyArguments {
  std::string in;
  std::string truth;
  std::vector<double> shares = {0.0, 0.1, 0.3, 0.5, 0.7, 0.9};
  std::vector<std::string> patterns = {"random", "groups"};
  std::vector<std::string> back_ends = back_end_names();
  double probability = 0.99;
  FalseLoopOptions false_loops;
  int max_iterations = 200;
};

const std::map<std::string, FalseLoopPattern> kPatterns = {{"random", FalseLoopPattern::Random},
                                                           {"groups", FalseLoopPattern::Groups}};

std::vector<Vertex> truth_of(const StudyArguments& arguments, const PoseGraph& graph, const OptimizeOptions& options) {
  if (arguments.truth.empty()) return optimum_without_false_loops(graph, options);
  std::vector<Vertex> truth = read_g2o(arguments.truth).vertices;
  if (truth.size() != graph.vertices.size()) {
    throw InputError(arguments.truth + ": has " + std::to_string(truth.size()) + " vertices, not " +
                     std::to_string(graph.vertices.size()) + " as " + arguments.in);
  }
  return truth;
}

void run_study(const StudyArguments& arguments) {
  const PoseGraph graph = read_g2o(arguments.in);
  RobustOptions options;
  options.inlier_probability = arguments.probability;
  options.optimize.max_iterations = arguments.max_iterations;
  const std::vector<Vertex> truth = truth_of(arguments, graph, options.optimize);
  const std::string name = std::filesystem::path(arguments.in).stem().string();
  std::cout << "| graph | false loops | back end | ATE [m] | precision | recall | solves | CPU [s] "
               "|\n|---|---|---|---|---|---|---|---|\n";
  for (const std::string& pattern : arguments.patterns) {
    for (const double share : arguments.shares) {
      // Nothing is false in two ways.
      if (share == 0.0 && pattern != arguments.patterns.front()) continue;
      for (const std::string& back_end : arguments.back_ends) {
        FalseLoopOptions false_loops = arguments.false_loops;
        false_loops.pattern = kPatterns.at(pattern);
        false_loops.share = share;
        options.back_end = *back_end_named(back_end);
        const FalseLoopTrial trial = try_false_loops(graph, truth, false_loops, options);
        std::cout << "| " << name << " | " << std::fixed << std::setprecision(0) << 100.0 * share << " %"
                  << (share == 0.0 ? "" : " " + pattern) << " | " << back_end << " | " << std::setprecision(3) << trial.ate_m
                  << " | " << trial.precision() << " | " << trial.recall() << " | " << trial.report.num_solves << " | "
                  << std::setprecision(2) << trial.cpu_s << " |" << std::endl;
      }
    }
  }
}

}  // namespace

void add_study_command(CLI::App& program) {
  const auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = program.add_subcommand(
      "study", "Add false loops to a .g2o graph and compare what the back ends make of it (a table in Markdown)");
  command->add_option("IN", arguments->in, "pose graph whose loops count as true (.g2o)")->required();
  command->add_option("--truth", arguments->truth,
                      "true poses (.g2o, the same vertices); default: the optimum without false loops");
  command->add_option("--shares", arguments->shares, "shares of the loops that are to be false")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 0.99))
      ->capture_default_str();
  command->add_option("--patterns", arguments->patterns, "each by chance, or in groups that agree with one another")
      ->delimiter(',')
      ->check(CLI::IsMember({"random", "groups"}))
      ->capture_default_str();
  command->add_option("--back-ends", arguments->back_ends, "which to compare")
      ->delimiter(',')
      ->check(CLI::IsMember(back_end_names()))
      ->capture_default_str();
  command->add_option("--robust-probability", arguments->probability, "as in `fabloop optimize`")
      ->check(CLI::Range(0.01, 0.999999))
      ->capture_default_str();
  command->add_option("--group-size", arguments->false_loops.group_size, "false loops in a group")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--max-iterations", arguments->max_iterations, "of one solve")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", arguments->false_loops.seed, "of the false loops")->capture_default_str();
  command->callback([arguments] { run_study(*arguments); });
}

}  // namespace fabloop::apps
