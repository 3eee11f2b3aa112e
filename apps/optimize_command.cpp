// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/robust_arguments.h"
#include "frontend/error.h"
#include "posegraph/g2o_io.h"
#include "posegraph/optimize.h"

namespace fabloop::apps {
namespace {

const std::map<std::string, Objective> kObjectives = {
    {"chordal", Objective::Chordal}, {"rotation-vector", Objective::RotationVector}, {"quaternion", Objective::Quaternion}};

struct OptimizeArguments {
  std::string in;
  std::string out;
  std::string objective = "chordal";
  RobustArguments robust;
  bool overwrite = false;
  bool strict = false;
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
  arguments.options.progress = make_progress(common);
  const auto start = std::chrono::steady_clock::now();
  std::optional<RobustReport> robust;
  if (asks_for_back_end(arguments.robust)) robust = robust_optimize(graph, robust_options(arguments.robust, arguments.options));
  const OptimizeReport report = robust ? robust->last_solve : optimize(graph, arguments.options);
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.termination == Termination::Failed) {
    throw InputError(arguments.in +
                     ": the solver found no usable step from these poses; remove the vertex lines to start from the edges");
  }
  write_g2o(arguments.out, graph);
  std::cout << std::setprecision(10) << "vertices    " << graph.vertices.size() << " (" << graph.dimension << "-D)\n"
            << "edges       " << graph.edges.size() << '\n'
            << "components  " << report.num_components << '\n'
            << "objective   " << arguments.objective << ", back end " << arguments.robust.back_end << '\n'
            << "cost        " << report.initial_cost << " -> " << report.final_cost << '\n'
            << "iterations  " << report.iterations << ", " << in_words(report.termination) << '\n'
            << "time        " << std::fixed << std::setprecision(2) << time_s << " s\n"
            << "wrote       " << arguments.out << '\n';
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
  add_robust_arguments(command, arguments->robust);
  command->add_option("--max-iterations", arguments->options.max_iterations, "stop after this many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--strict", arguments->strict, "refuse information matrices that are not positive semi-definite");
  command->add_flag("--overwrite", arguments->overwrite, "replace the output file if it exists");
  command->callback([arguments, &common] { run_optimize(*arguments, common); });
}

}  // namespace fabloop::apps
