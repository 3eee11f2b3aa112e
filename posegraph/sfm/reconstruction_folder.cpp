// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruction_folder.h"

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "frontend/output_file.h"
#include "frontend/recognition/plot.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/run/inlier_file.h"
#include "posegraph/run/ply.h"
#include "posegraph/run/run_folder.h"
#include "posegraph/sfm/colmap_io.h"
#include "posegraph/sfm/reconstruction_graph.h"
#include "posegraph/sfm/reconstruction_picture.h"
#include "posegraph/sfm/reconstruction_summary.h"
#include "verification/ledger.h"

namespace fabloop {
namespace {

void write_loops_csv(const std::filesystem::path& path, const Reconstructed& result) {
  OutputFile file(path);
  file.stream() << ledger_csv_head() << '\n';
  for (const LoopEvent& event : reconstruction_loops(result)) write_ledger(file.stream(), event, LedgerFormat::Csv);
  file.commit();
}

void write_picture(const std::filesystem::path& path, const Reconstructed& result) {
  std::vector<std::pair<std::size_t, std::size_t>> loops;
  const ReconstructionGraphOptions options;
  for (const SharedView& shared : shared_views(result, options)) {
    const auto& images = result.reconstruction.images;
    if (images[shared.query].frame - images[shared.match].frame > options.num_neighbours) {
      loops.emplace_back(shared.query, shared.match);
    }
  }
  write_png(path, draw_reconstruction(result.reconstruction, loops));
}

}  // namespace

void write_points_ply(const std::filesystem::path& path, const Reconstruction& reconstruction) {
  std::vector<ColouredPoint> points;
  for (const ScenePoint& point : reconstruction.points) points.push_back({point.x_in_world, point.red_green_blue});
  write_ply(path, points, "world of trajectory.tum");
}

void write_reconstruction_folder(const std::filesystem::path& path, const Sequence& sequence, const Reconstructed& result,
                                 const ReconstructOptions& options, OutputFolder::IfExists if_exists) {
  namespace fs = std::filesystem;
  const fs::path& state = options.state_folder;  // usually PATH.part: the folder is written within it
  OutputFolder folder(path, if_exists, fs::is_directory(state) ? state / "run" : fs::path{});
  const auto& part = folder.part_path();
  write_tum(part / "trajectory.tum", trajectory_of(result.reconstruction));
  if (!result.odometry.empty()) write_tum(part / "trajectory_odometry.tum", result.odometry);
  write_frames_csv(part / "frames.csv", sequence);
  write_points_ply(part / "points.ply", result.reconstruction);
  write_colmap_model(part / "colmap", result.reconstruction);
  write_g2o(part / "graph.g2o", reconstruction_graph(result));
  write_loops_csv(part / "loops.csv", result);
  write_inliers(part / "inliers.npy", shared_pixels(result));
  write_picture(part / "map.png", result);
  write_reconstruction_summary(part / "summary.json", sequence, result, options);
  folder.commit();
  std::error_code ignored;
  if (!state.empty()) fs::remove_all(state, ignored);
}

}  // namespace fabloop
