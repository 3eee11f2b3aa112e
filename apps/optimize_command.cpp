// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/robust_arguments.h"
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

struct OptimizeArguments {
  std::string in;
  std::string out;
  std::string objective = "chordal";
  std::string initialization = "lowest";
  RobustArguments robust;
  bool overwrite = false;
  bool strict = false;
  bool certify = false;
  OptimizeOptions options;
};

/// What came of a graph, by whichever way was asked for.
struct Solution {
  OptimizeReport report;
  std::optional<GlobalReport> global;
  std::optional<RobustReport> robust;
};

Solution solve(PoseGraph& graph, const OptimizeArguments& arguments) {
  Solution solution;
  if (asks_for_back_end(arguments.robust)) {
    OptimizeOptions options = arguments.options;
    options.initialization = Initialization::AsGiven;  // the back end says where its solves start
    solution.robust = robust_optimize(graph, robust_options(arguments.robust, options));
    solution.report = solution.robust->last_solve;
  } else if (arguments.certify) {
    GlobalOptions options;
    options.optimize = arguments.options;
    solution.global = optimize_globally(graph, options);
    solution.report = solution.global->optimize;
  } else {
    solution.report = optimize(graph, arguments.options);
  }
  return solution;
}

std::string_view start_in_words(const Solution& solution, const OptimizeArguments& arguments) {
  if (!solution.robust) return in_words(solution.report.start);
  return arguments.robust.as_given ? "the file's poses" : "where the odometry leads";
}

void run_optimize(OptimizeArguments& arguments, const CommonOptions& common) {
  if (!arguments.overwrite && std::filesystem::exists(arguments.out)) {
    throw InputError(arguments.out + ": exists already; choose another --out, or give --overwrite to replace it");
  }
  G2oOptions g2o_options;
  if (arguments.strict) g2o_options.if_indefinite = G2oOptions::IfIndefinite::Refuse;
  if (!common.quiet) g2o_options.warn = [](const std::string& message) { std::cerr << "note: " << message << '\n'; };
  PoseGraph graph = read_g2o(arguments.in, g2o_options);

  if (arguments.certify && asks_for_back_end(arguments.robust)) {
    throw InputError("--certify proves plain least squares; leave out --robust, --accept, --reject and --decisions");
  }
  arguments.options.objective = kObjectives.at(arguments.objective);
  arguments.options.initialization = kInitializations.at(arguments.initialization);
  arguments.options.progress = make_progress(common);
  const auto start = std::chrono::steady_clock::now();
  const Solution solution = solve(graph, arguments);
  const OptimizeReport& report = solution.report;
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.termination == Termination::Failed) {
    throw InputError(arguments.in + ": the solver found no usable step from these poses; give another --init");
  }
  write_g2o(arguments.out, graph);
  std::cout << std::setprecision(10) << "vertices    " << graph.vertices.size() << " (" << graph.dimension << "-D)\n"
            << "edges       " << graph.edges.size() << '\n'
            << "components  " << report.num_components << '\n'
            << "objective   " << arguments.objective << ", back end " << arguments.robust.back_end << '\n'
            << "start       " << start_in_words(solution, arguments) << '\n'
            << "cost        " << report.initial_cost << " -> " << report.final_cost << '\n'
            << "iterations  " << report.iterations << ", " << in_words(report.termination) << '\n';
  if (solution.global) {
    std::cout << "certificate " << solution.global->certificate.brief() << '\n'
              << "staircase   " << solution.global->num_extra_dimensions << " dimensions added\n";
  }
  std::cout << "time        " << std::fixed << std::setprecision(2) << time_s << " s\n"
            << "wrote       " << arguments.out << '\n';
  const std::optional<RobustReport>& robust = solution.robust;
  if (!robust) return;
  std::cout << "loops       " << robust->num_kept << " kept, " << robust->num_rejected << " rejected\n";
  if (!robust->is_proven) std::cout << "            the search for the largest consistent set was ended early\n";
  if (arguments.robust.decisions.empty()) return;
  write_decisions(arguments.robust.decisions, graph, *robust);
  std::cout << "wrote       " << arguments.robust.decisions << '\n';
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
          "poses to start from: as given, chained along a tree, the chordal relaxation, or whichever has the lowest cost; "
          "with --robust see --from-poses")
      ->check(CLI::IsMember({"given", "tree", "chordal", "lowest"}))
      ->capture_default_str();
  add_robust_arguments(command, arguments->robust);
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
