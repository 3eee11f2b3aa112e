// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/run_folder.h"

#include <cstdint>
#include <string>
#include <vector>

#include "frontend/sequence/sequence_trajectories.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/run/inlier_file.h"
#include "posegraph/run/map_picture.h"
#include "posegraph/run/ply.h"
#include "posegraph/run/run_summary.h"
#include "verification/ledger.h"

namespace fabloop {
RunErrors run_errors(const Sequence& sequence, const Map& map) {
  const Trajectory reference = reference_trajectory(sequence);
  return {absolute_trajectory_error(map.odometry_trajectory, reference),
          absolute_trajectory_error(map.online_trajectory, reference),
          absolute_trajectory_error(map.final_trajectory, reference)};
}

LoopCounts count_loops(const Map& map) {
  LoopCounts counts;
  for (const LoopEvent& event : map.events) {
    counts.num_hypotheses += event.hypotheses.size();
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      const bool accepted = outcome.verification.verdict == Verdict::Accepted;
      counts.num_accepted += accepted;
      counts.num_into_earlier += accepted && outcome.match_session != event.session;
      counts.num_with_scale += accepted && outcome.verification.has_scale;
    }
  }
  return counts;
}

void write_loops_csv(const std::filesystem::path& path, const Map& map) {
  OutputFile file(path);
  file.stream() << ledger_csv_head() << '\n';
  for (const LoopEvent& event : map.events) write_ledger(file.stream(), event, LedgerFormat::Csv);
  file.commit();
}

void write_points_ply(const std::filesystem::path& path, const Map& map) {
  std::vector<ColouredPoint> points;
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    const Pose& world_from_camera = map.graph.vertices[v].world_from_frame;
    for (std::size_t i = 0; i < map.views[v].points_in_camera.size(); ++i) {
      const auto& x_in_camera = map.views[v].points_in_camera[i];
      const std::uint8_t grey = map.grey[v][i];
      if (x_in_camera) points.push_back({world_from_camera * *x_in_camera, {grey, grey, grey}});
    }
  }
  write_ply(path, points, "world of trajectory.tum, metres of the odometry");
}

void write_frames_csv(const std::filesystem::path& path, const Sequence& sequence) {
  OutputFile file(path);
  file.stream() << "# filename,timestamp_s\n";
  for (const Frame& frame : sequence.frames) {
    file.stream() << frame.image_path.filename().string() << ',' << seconds_from_nanoseconds(frame.time_ns) << '\n';
  }
  file.commit();
}

void write_run_folder(const std::filesystem::path& path, const Sequence& sequence, const SequenceMap& result,
                      const MapSequenceOptions& options, OutputFolder::IfExists if_exists) {
  OutputFolder folder(path, if_exists);
  const auto& part = folder.part_path();
  write_tum(part / "trajectory.tum", result.map.final_trajectory);
  write_tum(part / "trajectory_online.tum", result.map.online_trajectory);
  write_tum(part / "trajectory_odometry.tum", result.map.odometry_trajectory);
  write_g2o(part / "graph.g2o", result.map.graph);
  write_loops_csv(part / "loops.csv", result.map);
  write_frames_csv(part / "frames.csv", sequence);
  write_inliers(part / "inliers.npy", result.map);
  write_points_ply(part / "points.ply", result.map);
  write_map_picture(part / "map.png", sequence, result.map);
  write_run_summary(part / "summary.json", sequence, result, options);
  folder.commit();
}

}  // namespace fabloop
