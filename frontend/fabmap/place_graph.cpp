// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_graph.h"

#include <algorithm>

namespace fabloop {

void link(PlaceGraph& graph, PlaceId from, PlaceId to) {
  const std::size_t wanted = static_cast<std::size_t>(std::max(from, to)) + 1;
  if (graph.next.size() < wanted) graph.next.resize(wanted);
  std::vector<PlaceId>& next = graph.next[from];
  if (from != to && std::find(next.begin(), next.end(), to) == next.end()) next.push_back(to);
}

PlaceGraph route(std::size_t num_places) {
  PlaceGraph graph;
  graph.next.resize(num_places);
  for (PlaceId place = 1; place < num_places; ++place) graph.next[place - 1].push_back(place);
  return graph;
}

}  // namespace fabloop
