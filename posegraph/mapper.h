// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/describe_sequence.h"
#include "posegraph/odometry_noise.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "verification/loop_closer.h"
#include "verification/map/keyframe_map_file.h"

namespace fabloop {

struct MapperOptions {
  LoopCloserOptions loops;  ///< Without `body_from_camera`: a sequence's odometry is its camera's.
  OptimizeOptions optimize{.objective = Objective::RotationVector, .robust_loss = RobustLoss::Cauchy};
  OdometryNoise odometry_noise;  ///< Where the images do not show it.
  /// After a loop, the graph is solved again once so many keyframes have come since the last time. 1 corrects at once; more
  /// bounds the time a keyframe takes on long runs.
  std::size_t solve_every = 10;
  /// A loop contradicts the rest of the map, and its verdict says so, when a right one would fit better with this probability. 1:
  /// none does, and all proven loops stay.
  double max_loop_surprise = 0.9999;
  /// Where to keep the keyframes for later sessions, each as it comes (see KeyframeMapFile). A file that exists must be the one
  /// that the earlier map was read from; it then goes on. Empty: nowhere.
  std::filesystem::path save_map{};
};

/// Seconds of each stage, one entry a keyframe (one a solve for `optimize_s`).
struct MapTimes {
  std::vector<double> read_s, describe_s, words_s, recognise_s, neighbour_s, verify_s, optimize_s;
};

/// What a mapped sequence looks like in the end.
struct Map {
  PoseGraph graph;                ///< Vertex ids are positions in the sequence.
  std::vector<LoopEvent> events;  ///< One a vertex: the ledger.
  Trajectory final_trajectory;    ///< World is the odometry's frame, anchored at the first keyframe.
  Trajectory online_trajectory;   ///< Each pose as it was believed when its frame was processed.
  Trajectory odometry_trajectory;
  std::vector<View> views;                      ///< One a vertex, with their points.
  std::vector<std::vector<std::uint8_t>> grey;  ///< One a vertex: of the image at each of the view's features.
  OdometryNoise odometry_noise;                 ///< As estimated.
  OptimizeReport report;                        ///< Of the last solve.
  MapTimes times;
  std::size_t num_without_odometry = 0;  ///< Frames left out for that reason.
};

/// The whole pipeline, image by image: appearance proposes, geometry proves, the graph bends.
class Mapper {
 public:
  /// Loops that lead into the `earlier` map are in the ledger; only those within the sequence bend this map. Throws InputError as
  /// LoopCloser and KeyframeMapFile do.
  Mapper(const Camera& camera, const Model& model, const MapperOptions& options = {}, KeyframeMap earlier = {});

  /// Frames in order of time. A frame without odometry is left out and counted.
  void process(const Frame& frame, DescribedFrame described);

  /// What there is so far: the graph as last solved, the ledger, the trajectories of odometry and of that time. The rest comes
  /// with finish().
  const Map& map() const { return map_; }

  /// Solves the whole graph, withdraws the loops that contradict it, and hands everything over.
  Map finish();

 private:
  void add_vertex(const Frame& frame, std::size_t position);
  /// A loop of the ledger.
  struct LoopPair {
    std::size_t query = 0;  ///< Position of its event.
    std::size_t match = 0;  ///< Keyframe::frame.
    std::size_t match_session = 0;
  };

  void take_loops();
  void add_loop_edge(const LoopClosure& loop);
  HypothesisOutcome& outcome_of(const LoopPair& pair);
  void tell_what_the_back_end_says();
  void add_neighbour_edge(const NeighbourLink& link);
  std::size_t vertex_of(std::size_t position) const;
  void solve();

  MapperOptions options_;
  LoopCloser loop_closer_;
  std::optional<KeyframeMapFile> map_file_;
  Map map_;
  std::vector<Pose> odom_from_cameras_;  ///< By vertex.
  std::vector<LoopPair> loops_;          ///< One a loop edge, in their order.
  std::vector<OdometryDifference> odometry_differences_;
  bool has_new_loop_ = false;
  std::size_t num_since_solve_ = 0;
};

}  // namespace fabloop
