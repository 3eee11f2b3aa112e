// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <sstream>
#include <string>

#include "posegraph/optimize.h"

namespace fabloop {

std::string_view in_words(Termination termination) {
  switch (termination) {
    case Termination::Converged:
      return "converged";
    case Termination::MaxIterations:
      return "stopped at the maximum number of iterations";
    case Termination::Cancelled:
      return "cancelled";
    case Termination::Failed:
      return "failed: the solver found no usable step";
    case Termination::NothingToDo:
      return "nothing to do: no edge or no free vertex";
  }
  return "";
}

std::string_view in_words(Initialization initialization) {
  switch (initialization) {
    case Initialization::AsGiven:
      return "poses as given";
    case Initialization::SpanningTree:
      return "chained along a spanning tree";
    case Initialization::Chordal:
      return "chordal relaxation";
    case Initialization::Sessions:
      return "sessions chained, and placed by the loops that agree";
    case Initialization::LowestCost:
      return "the start of lowest cost";
  }
  return "";
}

std::string OptimizeReport::brief() const {
  std::ostringstream text;
  text.precision(10);
  text << "cost " << initial_cost << " -> " << final_cost << " in " << iterations << " iterations, " << in_words(termination);
  return text.str();
}

std::string OptimizeReport::full() const {
  constexpr std::size_t kNumWorst = 5;
  std::ostringstream text;
  text << brief() << '\n';
  text << "start: " << in_words(start) << '\n';
  text << "edges: " << edges.size() << ", connected components: " << num_components << ", vertices held: " << anchors.size()
       << '\n';
  if (num_components > 1) text << "components have no edge between them, so each keeps its own place\n";
  if (num_components_without_scale > 0) {
    text << "components in which no edge knows a distance: " << num_components_without_scale << " (their size is arbitrary)\n";
  }
  if (num_mended_information > 0) {
    text << "information matrices that were not positive semi-definite, and were replaced by the nearest: "
         << num_mended_information << '\n';
  }
  const auto distrusted = std::count_if(edges.begin(), edges.end(), [](const EdgeResult& edge) { return edge.weight < 0.5; });
  text << "edges with robust weight below 0.5: " << distrusted << '\n';
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t shown = std::min(kNumWorst, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown), order.end(),
      [&](std::size_t a, std::size_t b) { return edges[a].chi2 != edges[b].chi2 ? edges[a].chi2 > edges[b].chi2 : a < b; });
  for (std::size_t i = 0; i < shown; ++i) {
    const EdgeResult& edge = edges[order[i]];
    text << "edge " << order[i] << ": chi2 " << edge.chi2 << ", weight " << edge.weight << '\n';
  }
  return text.str();
}

}  // namespace fabloop
