// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/fabmap/belief.h"

namespace fabloop {

/// Which places follow which: the neighbours that a camera can move to, along the links or against them. They may come from
/// the images' order, from a pose graph, or from a road map.
struct PlaceGraph {
  std::vector<std::vector<PlaceId>> next;  ///< For each place, those that follow it; no repeats.

  std::size_t num_places() const { return next.size(); }
};

/// Adds a link unless there is one already or both ends are one place. Places up to the higher end come into being.
void link(PlaceGraph& graph, PlaceId from, PlaceId to);

/// The graph of one route: each of `num_places` places is followed by the next.
PlaceGraph route(std::size_t num_places);

}  // namespace fabloop
