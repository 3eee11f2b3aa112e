// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "frontend/error.h"
#include "posegraph/g2o_io.h"
#include "posegraph/optimize.h"
#include "posegraph/staircase.h"

namespace fabloop::apps {
namespace {

const std::map<std::string, Objective> kObjectives = {
    {"chordal", Objective::Chordal}, {"rotation-vector", Objective::RotationVector}, {"quaternion", Objective::Quaternion}};
const std::map<std::string, Initialization> kInitializations = {{"given", Initialization::AsGiven},
                                                                {"tree", Initialization::SpanningTree},
                                                                {"chordal", Initialization::Chordal},
                                                                {"lowest", Initialization::LowestCost}};
const std::map<std::string, RobustLoss> kRobustLosses = {{"none", RobustLoss::None},
                                                         {"huber", RobustLoss::Huber},
                                                         {"cauchy", RobustLoss::Cauchy},
                                                         {"geman-mcclure", RobustLoss::GemanMcClure}};

struct OptimizeArguments {
  std::string in;
  std::string out;
  std::string objective = "chordal";
  std::string initialization = "lowest";
  std::string robust = "none";
  bool overwrite = false;
  bool strict = false;
  bool certify = false;
  OptimizeOptions options;
};

void run_optimize(OptimizeArguments& arguments, const CommonOptions& common) {
  if (!arguments.overwrite && std::filesystem::exists(arguments.out)) {
    throw InputError(arguments.out + ": exists already; choose another --out, or give --overwrite to replace it");
  }
  G2oOptions g2o_options;
  if (arguments.strict) g2o_options.if_indefinite = G2oOptions::IfIndefinite::Refuse;
  if (!common.quiet) g2o_options.warn = [](const std::string& message) { std::cerr << "note: " << message << '\n'; };
  PoseGraph graph = read_g2o(arguments.in, g2o_options);

  arguments.options.objective = kObjectives.at(arguments.objective);
  arguments.options.initialization = kInitializations.at(arguments.initialization);
  arguments.options.robust_loss = kRobustLosses.at(arguments.robust);
  arguments.options.progress = make_progress(common);
  const auto start = std::chrono::steady_clock::now();
  GlobalReport solution;
  if (arguments.certify) {
    GlobalOptions global_options;
    global_options.optimize = arguments.options;
    solution = optimize_globally(graph, global_options);
  } else {
    solution.optimize = optimize(graph, arguments.options);
  }
  const OptimizeReport& report = solution.optimize;
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.termination == Termination::Failed) {
    throw InputError(arguments.in + ": the solver found no usable step from these poses; give another --init");
  }
  write_g2o(arguments.out, graph);
  std::cout << std::setprecision(10) << "vertices    " << graph.vertices.size() << " (" << graph.dimension << "-D)\n"
            << "edges       " << graph.edges.size() << '\n'
            << "components  " << report.num_components << '\n'
            << "objective   " << arguments.objective << ", robust loss " << arguments.robust << '\n'
            << "start       " << in_words(report.start) << '\n'
            << "cost        " << report.initial_cost << " -> " << report.final_cost << '\n'
            << "iterations  " << report.iterations << ", " << in_words(report.termination) << '\n';
  if (arguments.certify) {
    std::cout << "certificate " << solution.certificate.brief() << '\n'
              << "staircase   " << solution.num_extra_dimensions << " dimensions added\n";
  }
  std::cout << "time        " << std::fixed << std::setprecision(2) << time_s << " s\n"
            << "wrote       " << arguments.out << '\n';
}

}  // namespace

void add_optimize_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<OptimizeArguments>();
  CLI::App* command = program.add_subcommand("optimize", "Move the poses of a .g2o graph to where its edges agree best");
  command->add_option("IN", arguments->in, "pose graph (.g2o, 2-D or 3-D)")->required();
  command->add_option("--out", arguments->out, "where to write the optimised graph (.g2o)")->required();
  command->add_option("--objective", arguments->objective, "how an edge's error is defined")
      ->check(CLI::IsMember({"chordal", "rotation-vector", "quaternion"}))
      ->capture_default_str();
  command
      ->add_option(
          "--init", arguments->initialization,
          "poses to start from: as given, chained along a tree, the chordal relaxation, or whichever has the lowest cost")
      ->check(CLI::IsMember({"given", "tree", "chordal", "lowest"}))
      ->capture_default_str();
  command->add_option("--robust", arguments->robust, "robust loss on loops (edges between ids that are not consecutive)")
      ->check(CLI::IsMember({"none", "huber", "cauchy", "geman-mcclure"}))
      ->capture_default_str();
  command
      ->add_option("--robust-probability", arguments->options.robust_probability,
                   "chi-square probability at which the robust loss begins; lower distrusts more")
      ->check(CLI::Range(0.01, 0.999999))
      ->capture_default_str();
  command->add_option("--max-iterations", arguments->options.max_iterations, "stop after this many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--certify", arguments->certify,
                    "prove that the optimum is global, or climb out of the local one (chordal objective, no robust loss)");
  command->add_flag("--strict", arguments->strict, "refuse information matrices that are not positive semi-definite");
  command->add_flag("--overwrite", arguments->overwrite, "replace the output file if it exists");
  command->callback([arguments, &common] { run_optimize(*arguments, common); });
}

}  // namespace fabloop::apps
