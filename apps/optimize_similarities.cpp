// SPDX-License-Identifier: BSD-3-Clause
#include "apps/optimize_similarities.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>

#include "frontend/error.h"
#include "posegraph/g2o/similarity_g2o_io.h"

namespace fabloop::apps {
namespace {

const std::map<std::string, RobustLoss> kLosses = {{"none", RobustLoss::None},
                                                   {"huber", RobustLoss::Huber},
                                                   {"cauchy", RobustLoss::Cauchy},
                                                   {"geman-mcclure", RobustLoss::GemanMcClure},
                                                   {"dcs", RobustLoss::DynamicCovarianceScaling}};

void check_for_similarities(const SimilarityArguments& arguments, const RobustArguments& robust) {
  const std::string has = arguments.in + ": has similarities, ";
  if (arguments.certify) throw InputError(has + "for which there is no certificate; leave out --certify");
  if (!robust.accept.empty() || !robust.reject.empty() || !robust.decisions.empty()) {
    throw InputError(has + "for which edges are not decided one by one; leave out --accept, --reject and --decisions");
  }
  if (!kLosses.contains(robust.back_end)) {
    throw InputError(has + "for which --robust takes none, huber, cauchy, geman-mcclure or dcs, not " + robust.back_end);
  }
}

}  // namespace

void optimize_similarities(const SimilarityArguments& arguments, const RobustArguments& robust, OptimizeOptions options,
                           const G2oOptions& g2o_options) {
  check_for_similarities(arguments, robust);
  SimilarityGraph graph = read_similarity_g2o(arguments.in, g2o_options);
  options.robust_loss = kLosses.at(robust.back_end);
  options.robust_probability = robust.probability;
  if (robust.as_given) options.initialization = Initialization::AsGiven;
  const auto start = std::chrono::steady_clock::now();
  const OptimizeReport report = optimize(graph, options);
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.termination == Termination::Failed) {
    throw InputError(arguments.in + ": the solver found no usable step from these poses; give another --init");
  }
  write_g2o(arguments.out, graph);
  const auto by_scale = [](const SimilarityVertex& a, const SimilarityVertex& b) {
    return a.world_from_frame.scale < b.world_from_frame.scale;
  };
  const auto [smallest, largest] = std::minmax_element(graph.vertices.begin(), graph.vertices.end(), by_scale);
  std::cout << std::setprecision(10) << "vertices    " << graph.vertices.size() << " (3-D with scale)\n"
            << "edges       " << graph.edges.size() << '\n'
            << "components  " << report.num_components << '\n'
            << "objective   " << arguments.objective << ", loss " << robust.back_end << '\n'
            << "start       " << in_words(report.start) << '\n'
            << "cost        " << report.initial_cost << " -> " << report.final_cost << '\n'
            << "iterations  " << report.iterations << ", " << in_words(report.termination) << '\n'
            << "scales      " << smallest->world_from_frame.scale << " to " << largest->world_from_frame.scale << '\n'
            << "time        " << std::fixed << std::setprecision(2) << time_s << " s\n"
            << "wrote       " << arguments.out << '\n';
}

}  // namespace fabloop::apps
