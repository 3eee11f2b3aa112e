// SPDX-License-Identifier: BSD-3-Clause
#include "apps/robust_arguments.h"

#include <algorithm>

#include "frontend/output_file.h"

namespace fabloop::apps {
namespace {

const char* name_of(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::Odometry:
      return "odometry";
    case EdgeKind::Neighbour:
      return "neighbour";
    case EdgeKind::Loop:
      return "loop";
  }
  return "";
}

}  // namespace

std::vector<std::string> back_end_names() {
  std::vector<std::string> names;
  for (const BackEnd back_end : all_back_ends()) names.emplace_back(to_string(back_end));
  return names;
}

void add_robust_arguments(CLI::App* command, RobustArguments& arguments) {
  command
      ->add_option("--robust", arguments.back_end,
                   "back end against false loops (loops: edges between ids that are not consecutive); gnc-truncated where unsure")
      ->check(CLI::IsMember(back_end_names()))
      ->capture_default_str();
  command
      ->add_option("--robust-probability", arguments.probability,
                   "probability that a right loop has a chi-square below the threshold; lower rejects more")
      ->check(CLI::Range(0.01, 0.999999))
      ->capture_default_str();
  command
      ->add_option("--accept", arguments.accept,
                   "loops to believe whatever they look like: positions of edges in the file, counted from 0 over all edges")
      ->delimiter(',');
  command->add_option("--reject", arguments.reject, "loops to leave out: positions as for --accept")->delimiter(',');
  command->add_flag("--from-poses", arguments.as_given,
                    "with --robust: start from the file's poses, not from where its odometry leads");
  command->add_option("--decisions", arguments.decisions,
                      "with --robust: write chi-square, weight and verdict of every edge to this file (CSV)");
}

RobustOptions robust_options(const RobustArguments& arguments, const OptimizeOptions& optimize) {
  RobustOptions options;
  options.back_end = *back_end_named(arguments.back_end);
  options.inlier_probability = arguments.probability;
  options.accept = arguments.accept;
  options.reject = arguments.reject;
  if (arguments.as_given) options.start = RobustStart::AsGiven;
  options.optimize = optimize;
  return options;
}

bool asks_for_back_end(const RobustArguments& arguments) {
  return arguments.back_end != "none" || !arguments.accept.empty() || !arguments.reject.empty() || !arguments.decisions.empty();
}

void write_decisions(const std::filesystem::path& path, const PoseGraph& graph, const RobustReport& report) {
  OutputFile file(path);
  file.stream().precision(6);
  file.stream() << "edge,from,to,kind,chi2,weight,verdict\n";
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    const EdgeDecision& decision = report.edges[e];
    file.stream() << e << ',' << graph.vertices[edge.from].id << ',' << graph.vertices[edge.to].id << ',' << name_of(edge.kind)
                  << ',' << decision.chi2 << ',' << decision.weight << ',' << to_string(decision.verdict) << '\n';
  }
  file.commit();
}

}  // namespace fabloop::apps
