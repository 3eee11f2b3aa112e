// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/false_loops.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// Random numbers that are the same on every platform (Steele et al., OOPSLA 2014: SplitMix64).
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}

  /// Uniform in [0, 1).
  double uniform() {
    std::uint64_t x = state_ += 0x9E3779B97F4A7C15ULL;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1.0p-53;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  std::size_t below(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(uniform() * static_cast<double>(count)));
  }

 private:
  std::uint64_t state_;
};

class Maker {
 public:
  Maker(const PoseGraph& graph, const FalseLoopOptions& options) : graph_(graph), options_(options), draw_(options.seed) {
    for (const Edge& edge : graph.edges) {
      if (edge.kind == EdgeKind::Loop) loops_.push_back(&edge);
    }
    if (!(options.share >= 0.0 && options.share < 1.0)) throw InputError("false loops: their share must be in [0, 1)");
    if (loops_.empty()) throw InputError("false loops: the graph has no loops to be like");
    if (graph.vertices.size() < 4) throw InputError("false loops: the graph needs four vertices or more");
  }

  std::vector<Edge> make() {
    const auto num_true = static_cast<double>(loops_.size());
    const auto count = static_cast<std::size_t>(std::llround(num_true * options_.share / (1.0 - options_.share)));
    std::vector<Edge> result;
    while (result.size() < count) {
      if (options_.pattern == FalseLoopPattern::Random) {
        result.push_back(random_loop());
      } else {
        for (Edge& edge : group(std::min(options_.group_size, count - result.size()))) result.push_back(std::move(edge));
      }
    }
    return result;
  }

 private:
  /// What a true loop measured.
  Edge any_loop() { return *loops_[draw_.below(loops_.size())]; }

  Edge random_loop() {
    const std::size_t size = graph_.vertices.size();
    std::size_t from = draw_.below(size);
    std::size_t to = draw_.below(size);
    // Neighbours would be taken for odometry.
    while (from + 1 >= to && to + 1 >= from) {
      from = draw_.below(size);
      to = draw_.below(size);
    }
    Edge edge = any_loop();
    edge.from = std::min(from, to);
    edge.to = std::max(from, to);
    return edge;
  }

  /// The second stretch is seen where the first is: the pose of one loop, carried along both.
  std::vector<Edge> group(std::size_t count) {
    const std::size_t size = graph_.vertices.size();
    const std::size_t length = std::max<std::size_t>(1, std::min(count, size / 2 - 1));
    const std::size_t first = draw_.below(size - 2 * length);
    const std::size_t second = first + length + 1 + draw_.below(size - first - 2 * length);
    const Edge start = any_loop();
    const auto pose_of = [&](std::size_t v) { return graph_.vertices[v].world_from_frame; };
    std::vector<Edge> result;
    for (std::size_t k = 0; k < length; ++k) {
      const Pose from_from_first = pose_of(first + k).inverse() * pose_of(first);
      const Pose second_from_to = pose_of(second).inverse() * pose_of(second + k);
      Edge edge = start;
      edge.from = first + k;
      edge.to = second + k;
      edge.from_from_to = from_from_first * start.from_from_to * second_from_to;
      if (!edge.has_scale) edge.from_from_to.translation.normalize();
      result.push_back(edge);
    }
    return result;
  }

  const PoseGraph& graph_;
  const FalseLoopOptions& options_;
  Draw draw_;
  std::vector<const Edge*> loops_;
};

}  // namespace

std::vector<std::size_t> add_false_loops(PoseGraph& graph, const FalseLoopOptions& options) {
  const std::vector<Edge> added = Maker(graph, options).make();
  std::vector<std::size_t> positions;
  for (const Edge& edge : added) {
    positions.push_back(graph.edges.size());
    graph.edges.push_back(edge);
  }
  return positions;
}

}  // namespace fabloop
