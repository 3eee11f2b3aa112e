// SPDX-License-Identifier: BSD-3-Clause
#include "apps/run_truth.h"

#include "frontend/error.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

/// The folder that has `pairs.csv` and `reference.tum`; empty where the truth is one file.
fs::path truth_folder(const fs::path& truth) {
  if (fs::is_directory(truth)) return truth;
  return truth.filename() == "pairs.csv" ? truth.parent_path() : fs::path{};
}

std::vector<std::int64_t> frame_times(const TruthArguments& arguments) {
  if (!arguments.frames.empty()) return read_frame_times(arguments.frames);
  if (const fs::path folder = truth_folder(arguments.truth); !folder.empty()) {
    for (const char* name : {"frames.csv", "track.csv"}) {
      if (fs::exists(folder / name)) return read_frame_times(folder / name);
    }
  }
  const fs::path of_run = arguments.run / "frames.csv";
  if (!fs::exists(of_run)) {
    throw InputError(of_run.string() +
                     ": is missing, so loops cannot be dated; give --frames FILE or a sequence folder as --truth");
  }
  return read_frame_times(of_run);
}

}  // namespace

std::optional<fs::path> reference_path(const TruthArguments& arguments) {
  const fs::path folder = truth_folder(arguments.truth);
  if (!folder.empty()) return folder / "reference.tum";
  if (fs::exists(arguments.truth) && is_loop_matrix(arguments.truth)) return std::nullopt;
  return arguments.truth;
}

void set_false_radius(TruthArguments& truth, LoopEvaluationOptions& loops, std::optional<double> wanted_m) {
  loops.false_radius_m = false_radius_m(truth.places.poses, loops.height_above_ground_m, wanted_m);
  truth.places.poses.not_judged_radius_m = loops.false_radius_m;
}

RunTruth read_run_truth(const TruthArguments& arguments) {
  RunTruth truth;
  if (const auto path = reference_path(arguments)) truth.reference = read_tum(*path);
  truth.frame_times_ns = frame_times(arguments);
  truth.loops.world_from_camera = reference_poses(truth.frame_times_ns, truth.reference, arguments.places.max_time_difference_s);
  const fs::path pairs = truth_folder(arguments.truth) / "pairs.csv";
  if (!truth_folder(arguments.truth).empty() && fs::exists(pairs)) truth.loops.pairs = read_pairs(pairs);
  std::vector<ObservedImage> images(truth.frame_times_ns.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].frame = i;
    images[i].time_ns = truth.frame_times_ns[i];
  }
  truth.places = read_truth(arguments.truth, images, arguments.places);
  return truth;
}

}  // namespace fabloop::apps
