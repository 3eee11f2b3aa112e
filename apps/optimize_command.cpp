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
#include "apps/optimize_similarities.h"
#include "apps/progress_bar.h"
#include "apps/robust_arguments.h"
#include "frontend/error.h"
#include "posegraph/certificate/staircase.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/similarity_g2o_io.h"
#include "posegraph/optimize.h"

namespace fabloop::apps {
namespace {

const std::map<std::string, Objective> kObjectives = {
    {"chordal", Objective::Chordal}, {"rotation-vector", Objective::RotationVector}, {"quaternion", Objective::Quaternion}};
const std::map<std::string, Initialization> kInitializations = {{"given", Initialization::AsGiven},
                                                                {"tree", Initialization::SpanningTree},
                                                                {"chordal", Initialization::Chordal},
                                                                {"sessions", Initialization::Sessions},
                                                                {"lowest", Initialization::LowestCost}};

struct OptimizeArguments {
  std::string in;
  std::string out;
  std::string objective = "chordal";
  std::string initialization;
  std::string freedom = "full";
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

/// What cannot be asked for together.
void check_together(const OptimizeArguments& arguments) {
  const bool has_back_end = asks_for_back_end(arguments.robust);
  if (arguments.certify && has_back_end) {
    throw InputError("--certify proves plain least squares; leave out --robust, --accept, --reject and --decisions");
  }
  if (arguments.freedom == "full") return;
  if (arguments.certify) throw InputError("--certify proves optima of whole poses; leave out --freedom");
  if (has_back_end && !arguments.robust.as_given) {
    throw InputError("--freedom yaw keeps roll and pitch of the file's poses: add --from-poses to start from them");
  }
}

OptimizeOptions solver_options(const OptimizeArguments& arguments, const CommonOptions& common) {
  OptimizeOptions options = arguments.options;
  const bool is_yaw = arguments.freedom == "yaw";
  const std::string usual = is_yaw ? "given" : "lowest";
  options.objective = kObjectives.at(arguments.objective);
  options.initialization = kInitializations.at(arguments.initialization.empty() ? usual : arguments.initialization);
  if (is_yaw) options.freedom = Freedom::YawAndPosition;
  options.progress = make_progress(common);
  return options;
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
  check_together(arguments);
  arguments.options = solver_options(arguments, common);
  if (has_similarities(arguments.in)) {
    return optimize_similarities({arguments.in, arguments.out, arguments.objective, arguments.certify}, arguments.robust,
                                 arguments.options, g2o_options);
  }
  PoseGraph graph = read_g2o(arguments.in, g2o_options);
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
  command->add_option("IN", arguments->in, "pose graph (.g2o: 2-D, 3-D or similarities; or TORO's lines)")->required();
  command->add_option("--out", arguments->out, "where to write the optimised graph (.g2o)")->required();
  command->add_option("--objective", arguments->objective, "how an edge's error is defined")
      ->check(CLI::IsMember({"chordal", "rotation-vector", "quaternion"}))
      ->capture_default_str();
  command
      ->add_option("--init", arguments->initialization,
                   "poses to start from: as given, chained along a tree, the chordal relaxation, several sessions placed by the "
                   "loops that "
                   "agree, or whichever has the lowest cost [lowest; given with --freedom yaw]; with --robust see --from-poses")
      ->check(CLI::IsMember({"given", "tree", "chordal", "sessions", "lowest"}));
  command
      ->add_option("--freedom", arguments->freedom,
                   "what may move: whole poses, or yaw and position alone where gravity tells roll and pitch (z is up)")
      ->check(CLI::IsMember({"full", "yaw"}))
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
