// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/place_graph.h"

namespace fabloop {

/// How a camera moves from one image to the next, among places along a route or in a graph (Cummins & Newman 2008).
struct MotionModel {
  /// Probability that the next image shows a place that is not in the map, before anything is known of the motion. Less for
  /// routes that are driven again and again.
  double p_new = 0.5;
  /// Probability of being anywhere on the map instead of near the last place: what lets a loop be found at all. One ignores
  /// where the camera was.
  double p_teleport = 0.5;
  std::size_t reach = 1;  ///< Furthest move between two images, in places. More where images come slowly.
  /// Of the moves that are not a stay, the part that follows the links, the way the route was travelled. 1 for a one-way
  /// street, 0.5 where the camera may turn.
  double p_forward = 0.5;
};

/// The prior for the next image on a route, where each place is followed by the next. `previous` is the belief after the last
/// image, over the first places of the map; `num_places` is how many there are now. If one was added since, it is where the
/// last image was if that was new. Moves that leave the route at either end lead to a new place. Sums to one. Throws
/// InputError when the model's numbers are no probabilities, or when there are fewer places than `previous` has or more than
/// one more.
Prior predict(const MotionModel& motion, const Belief& previous, std::size_t num_places);

/// The same where `graph` says which places follow which, among the `graph.num_places()` places there are now. A move of n
/// places takes n links, each time any of them with equal probability; where none goes on, it leads to a new place.
/// predict(motion, previous, route(n)) equals predict(motion, previous, n). Throws InputError as that does, and when a link
/// ends at a place that the graph does not have.
Prior predict(const MotionModel& motion, const Belief& previous, const PlaceGraph& graph);

}  // namespace fabloop
