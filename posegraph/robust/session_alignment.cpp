// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/session_alignment.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "posegraph/robust/loop_consistency.h"

namespace fabloop {
namespace {

bool contains(const std::vector<EdgeKind>& kinds, EdgeKind kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

PoseGraph trusted_part(const PoseGraph& graph, const std::vector<EdgeKind>& doubted) {
  PoseGraph trusted;
  trusted.dimension = graph.dimension;
  trusted.vertices = graph.vertices;
  for (const Edge& edge : graph.edges) {
    if (!contains(doubted, edge.kind)) trusted.edges.push_back(edge);
  }
  return trusted;
}

/// The sessions of a loop's earlier and of its later vertex. Where vertices of two sessions alternate, loops one way round and
/// the other are counted apart: LoopConsistency has all loops begin at their earlier vertex.
using Pair = std::pair<std::size_t, std::size_t>;

/// Loops with scale between different sessions, as positions in `LoopConsistency::edges()`.
std::map<Pair, std::vector<std::size_t>> loops_by_pair(const PoseGraph& graph, const LoopConsistency& loops,
                                                       const Components& sessions) {
  std::map<Pair, std::vector<std::size_t>> result;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const Edge& edge = graph.edges[loops.edges()[k]];
    const Pair pair{sessions.of_vertex[std::min(edge.from, edge.to)], sessions.of_vertex[std::max(edge.from, edge.to)]};
    if (pair.first != pair.second && edge.has_scale) result[pair].push_back(k);
  }
  return result;
}

/// The loop that most of them agree with, the first of equals.
SessionJoin consensus(const LoopConsistency& loops, const std::vector<std::size_t>& of_pair, std::size_t max_proposals) {
  const std::size_t num_proposals = std::clamp<std::size_t>(max_proposals, 1, of_pair.size());
  SessionJoin best;
  best.num_loops = of_pair.size();
  for (std::size_t p = 0; p < num_proposals; ++p) {
    const std::size_t proposal = of_pair[p * of_pair.size() / num_proposals];
    std::size_t num_agreeing = 1;
    for (const std::size_t other : of_pair) num_agreeing += other != proposal && loops.are_consistent(proposal, other);
    if (num_agreeing <= best.num_agreeing) continue;
    best.num_agreeing = num_agreeing;
    best.edge = loops.edges()[proposal];
  }
  return best;
}

/// Moves `join.session` to where the loop says it is.
void place(PoseGraph& graph, const Components& sessions, const SessionJoin& join) {
  const Edge& edge = graph.edges[join.edge];
  const bool moves_from = sessions.of_vertex[edge.from] == join.session;
  const Pose placed_from_moved = moves_from ? edge.from_from_to.inverse() : edge.from_from_to;
  const Vertex& placed = graph.vertices[moves_from ? edge.to : edge.from];
  const Vertex& moved = graph.vertices[moves_from ? edge.from : edge.to];
  const Pose world_from_old = placed.world_from_frame * placed_from_moved * moved.world_from_frame.inverse();
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    Pose& pose = graph.vertices[v].world_from_frame;
    if (sessions.of_vertex[v] == join.session) pose = world_from_old * pose;
  }
}

/// The strongest join of a session without a place to one that has it; none where no loop leads out.
std::optional<SessionJoin> strongest(const std::map<Pair, SessionJoin>& joins, const std::vector<bool>& is_placed) {
  std::optional<SessionJoin> best;
  for (const auto& [pair, join] : joins) {
    if (is_placed[pair.first] == is_placed[pair.second] || (best && join.num_agreeing <= best->num_agreeing)) continue;
    best = join;
    best->session = is_placed[pair.first] ? pair.second : pair.first;
    best->placed_in = is_placed[pair.first] ? pair.first : pair.second;
  }
  return best;
}

}  // namespace

std::size_t num_sessions(const PoseGraph& graph, const std::vector<EdgeKind>& doubted) {
  return connected_components(trusted_part(graph, doubted)).count;
}

void chain_sessions(PoseGraph& graph, const std::vector<EdgeKind>& doubted) {
  PoseGraph trusted = trusted_part(graph, doubted);
  chain_along_edges(trusted);
  graph.vertices = std::move(trusted.vertices);
}

SessionAlignment align_sessions(PoseGraph& graph, const SessionAlignmentOptions& options) {
  check(graph);
  SessionAlignment result{connected_components(trusted_part(graph, options.doubted)), {}};
  const Components& sessions = result.sessions;
  if (sessions.count < 2) return result;
  const LoopConsistency loops(graph, options.doubted, options.inlier_probability);
  std::map<Pair, SessionJoin> joins;
  for (const auto& [pair, of_pair] : loops_by_pair(graph, loops, sessions)) {
    joins[pair] = consensus(loops, of_pair, options.max_proposals);
  }
  std::vector<bool> is_placed(sessions.count, false);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (graph.vertices[v].fixed) is_placed[sessions.of_vertex[v]] = true;
  }
  // Sessions that no loop joins, however far around, to a placed one: the first of them stays, and the others come to it.
  for (std::size_t session = 0; session < sessions.count; ++session) {
    const bool is_first = session == 0 && std::find(is_placed.begin(), is_placed.end(), true) == is_placed.end();
    if (is_first) is_placed[session] = true;
    while (const std::optional<SessionJoin> join = strongest(joins, is_placed)) {
      place(graph, sessions, *join);
      is_placed[join->session] = true;
      result.joins.push_back(*join);
    }
    is_placed[session] = true;
  }
  return result;
}

}  // namespace fabloop
