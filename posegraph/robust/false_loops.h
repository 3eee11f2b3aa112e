// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// How false loops come.
enum class FalseLoopPattern {
  /// Each by chance: between any two vertices, with the pose that one of the true loops measured.
  Random,
  /// In groups, as aliasing makes them (one street taken for another): consecutive vertices of one stretch matched to those of
  /// another, all with the same error, so that they agree with one another and with the true shape of both stretches.
  Groups,
};

/// What add_false_loops() may be told.
struct FalseLoopOptions {
  FalseLoopPattern pattern = FalseLoopPattern::Random;
  /// Share of all loops that are false afterwards, in [0, 1).
  double share = 0.5;
  /// Number of false loops in a group.
  std::size_t group_size = 10;
  std::uint64_t seed = 1;
};

/// Adds false loops after the graph's edges, each with pose and information of one of its loops (what a verifier lets through
/// looks like a loop), and returns their positions. For groups, the poses of the graph should be about right: they tell what the
/// stretches look like. The same input gives the same bytes on every platform. Throws InputError for a share outside [0, 1), and
/// for a graph without loops or with fewer than four vertices.
std::vector<std::size_t> add_false_loops(PoseGraph& graph, const FalseLoopOptions& options = {});

}  // namespace fabloop
