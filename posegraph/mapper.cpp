// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/mapper.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "posegraph/loop_withdrawal.h"
#include "verification/median.h"

namespace fabloop {
namespace {

Edge odometry_edge(std::size_t from, const Pose& from_from_to) {
  Edge edge;
  edge.from = from;
  edge.to = from + 1;
  edge.from_from_to = from_from_to;
  edge.kind = EdgeKind::Odometry;
  return edge;
}

/// Length of a typical step, below which a step is as uncertain as a typical one's tenth.
double median_step(const std::vector<Edge>& edges) {
  std::vector<double> lengths;
  for (const Edge& edge : edges) {
    if (edge.kind == EdgeKind::Odometry) lengths.push_back(edge.from_from_to.translation.norm());
  }
  return median(std::move(lengths));
}

/// A sequence's odometry is its camera's.
LoopCloserOptions as_of_cameras(LoopCloserOptions options) {
  options.body_from_camera = {};
  return options;
}

}  // namespace

Mapper::Mapper(const Camera& camera, const Model& model, const MapperOptions& options, KeyframeMap earlier)
    : options_(options), loop_closer_(camera, model, as_of_cameras(options.loops), std::move(earlier)) {
  if (options.save_map.empty()) return;
  map_file_ = std::filesystem::exists(options.save_map) ? KeyframeMapFile::open(options.save_map, model)
                                                        : KeyframeMapFile::create(options.save_map, loop_closer_.map());
}

void Mapper::process(const Frame& frame, DescribedFrame described) {
  if (!frame.odom_from_camera) {
    ++map_.num_without_odometry;
    return;
  }
  LoopEvent event = loop_closer_.add_keyframe({.frame = described.frame,
                                               .time_ns = frame.time_ns,
                                               .odom_from_body = *frame.odom_from_camera,
                                               .features = std::move(described.features)});
  if (map_file_) map_file_->put(loop_closer_.map(), event.changed);
  add_vertex(frame, described.frame);
  for (const NeighbourLink& link : event.neighbours) add_neighbour_edge(link);
  map_.times.words_s.push_back(event.times.words_s);
  map_.times.recognise_s.push_back(event.times.recognise_s);
  map_.times.neighbour_s.push_back(event.times.neighbour_s);
  map_.times.verify_s.push_back(event.times.verify_s);
  map_.events.push_back(std::move(event));
  take_loops();
  if (has_new_loop_ && num_since_solve_ >= options_.solve_every) solve();
  ++num_since_solve_;
  map_.online_trajectory.push_back({frame.time_ns, map_.graph.vertices.back().world_from_frame});

  map_.times.read_s.push_back(described.read_s);
  map_.times.describe_s.push_back(described.describe_s);
  map_.grey.push_back(std::move(described.grey));
}

void Mapper::add_vertex(const Frame& frame, std::size_t position) {
  Vertex vertex;
  vertex.id = static_cast<std::int64_t>(position);
  vertex.world_from_frame = *frame.odom_from_camera;
  if (!map_.graph.vertices.empty()) {
    const Pose previous_from_current = odom_from_cameras_.back().inverse() * *frame.odom_from_camera;
    map_.graph.edges.push_back(odometry_edge(map_.graph.vertices.size() - 1, previous_from_current));
    vertex.world_from_frame = map_.graph.vertices.back().world_from_frame * previous_from_current;
  }
  map_.graph.vertices.push_back(vertex);
  odom_from_cameras_.push_back(*frame.odom_from_camera);
  map_.odometry_trajectory.push_back({frame.time_ns, *frame.odom_from_camera});
}

void Mapper::add_neighbour_edge(const NeighbourLink& link) {
  Edge edge;
  edge.from = vertex_of(link.previous);
  edge.to = map_.graph.vertices.size() - 1;
  edge.from_from_to = {link.previous_from_current.rotation, link.previous_from_current.translation.normalized()};
  edge.information = link.information;
  edge.kind = EdgeKind::Neighbour;
  edge.has_scale = false;
  map_.graph.edges.push_back(edge);
  odometry_differences_.push_back({edge.to - edge.from, link.rotation_error_deg, link.direction_error_deg});
}

void Mapper::take_loops() {
  const LoopEvent& event = map_.events.back();
  for (const std::vector<LoopClosure>* loops : {&event.loops, &event.confirmed}) {
    for (const LoopClosure& loop : *loops) {
      outcome_of({vertex_of(loop.query), loop.match, loop.match_session}).verification.verdict = Verdict::Accepted;
      if (loop.match_session == event.session) add_loop_edge(loop);
    }
  }
}

void Mapper::add_loop_edge(const LoopClosure& loop) {
  Edge edge;
  edge.from = vertex_of(loop.match);
  edge.to = vertex_of(loop.query);
  edge.from_from_to = loop.match_from_query;
  edge.information = loop.information;
  edge.kind = EdgeKind::Loop;
  edge.has_scale = loop.has_scale;
  map_.graph.edges.push_back(edge);
  loops_.push_back({edge.to, loop.match, loop.match_session});
  has_new_loop_ = true;
}

HypothesisOutcome& Mapper::outcome_of(const LoopPair& pair) {
  std::vector<HypothesisOutcome>& hypotheses = map_.events[pair.query].hypotheses;
  const auto found = std::find_if(hypotheses.begin(), hypotheses.end(), [&](const HypothesisOutcome& outcome) {
    return outcome.match == pair.match && outcome.match_session == pair.match_session;
  });
  return *found;
}

void Mapper::tell_what_the_back_end_says() {
  std::size_t loop = 0;
  for (std::size_t i = 0; i < map_.graph.edges.size(); ++i) {
    if (map_.graph.edges[i].kind != EdgeKind::Loop) continue;
    HypothesisOutcome& outcome = outcome_of(loops_[loop++]);
    outcome.map_chi2 = map_.report.edges[i].chi2;
    outcome.map_weight = map_.report.edges[i].weight;
  }
}

std::size_t Mapper::vertex_of(std::size_t position) const {
  const auto& vertices = map_.graph.vertices;
  const auto found = std::lower_bound(vertices.begin(), vertices.end(), static_cast<std::int64_t>(position),
                                      [](const Vertex& vertex, std::int64_t id) { return vertex.id < id; });
  return static_cast<std::size_t>(found - vertices.begin());
}

void Mapper::solve() {
  const auto start = std::chrono::steady_clock::now();
  map_.odometry_noise = estimate_odometry_noise(odometry_differences_, options_.odometry_noise);
  constexpr double kStandstillShare = 0.1;
  const double min_length = std::max(1e-6, kStandstillShare * median_step(map_.graph.edges));
  for (Edge& edge : map_.graph.edges) {
    if (edge.kind != EdgeKind::Odometry) continue;
    edge.information = odometry_information(edge.from_from_to.translation.norm(), min_length, map_.odometry_noise);
  }
  map_.report = optimize(map_.graph, options_.optimize);
  has_new_loop_ = false;
  num_since_solve_ = 0;
  map_.times.optimize_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

Map Mapper::finish() {
  solve();
  tell_what_the_back_end_says();
  std::vector<Edge> kept;
  std::vector<LoopPair> kept_loops;
  std::size_t loop = 0;
  for (std::size_t i = 0; i < map_.graph.edges.size(); ++i) {
    const bool is_loop = map_.graph.edges[i].kind == EdgeKind::Loop;
    const bool contradicts = contradicts_map(map_.graph.edges[i], map_.report.edges[i].chi2, options_.max_loop_surprise);
    if (contradicts) outcome_of(loops_[loop]).verification.verdict = Verdict::ContradictsMap;
    if (!contradicts) kept.push_back(map_.graph.edges[i]);
    if (!contradicts && is_loop) kept_loops.push_back(loops_[loop]);
    loop += is_loop;
  }
  if (kept.size() < map_.graph.edges.size()) {
    map_.graph.edges = std::move(kept);
    loops_ = std::move(kept_loops);
    solve();
    tell_what_the_back_end_says();
  }
  for (std::size_t v = 0; v < map_.graph.vertices.size(); ++v) {
    map_.final_trajectory.push_back({map_.odometry_trajectory[v].time_ns, map_.graph.vertices[v].world_from_frame});
  }
  const KeyframeMap& keyframes = loop_closer_.map();
  for (std::size_t place = keyframes.keyframes.size() - map_.events.size(); place < keyframes.keyframes.size(); ++place) {
    map_.views.push_back(keyframes.keyframes[place].view);
  }
  return std::move(map_);
}

}  // namespace fabloop
