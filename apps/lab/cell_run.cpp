// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/cell_run.h"

#include <algorithm>
#include <utility>

#include "data/world_writer.h"
#include "frontend/baselines/place_scores.h"
#include "frontend/error.h"
#include "frontend/parallel.h"
#include "frontend/recognition/recognition_truth.h"
#include "frontend/sequence/sequence_trajectories.h"
#include "posegraph/own_model.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Renders the cell's world and flight. Returns how much of the ground is a copy.
double render(const SyntheticData& data, const LabCell& cell, const fs::path& folder, int num_threads) {
  SyntheticFlightOptions options;
  options.seed = cell.seed;
  options.camera = scaled(synthetic_camera(), data.camera_scale);
  options.flight.length_m = data.length_m;
  options.flight.spacing_m = data.spacing_m;
  options.flight.mean_height_m = data.mean_height_m;
  options.flight.height_spread_m = data.height_spread_m;
  options.flight.max_strip_gap_m = data.max_strip_gap_m;
  options.meadow.texture_m_per_px = data.texture_m_per_px;
  options.meadow.height_m_per_px = data.height_m_per_px;
  options.aliasing.share = cell.settings.aliasing;
  options.aliasing.tile_m = data.tile_m;
  for (double* error : {&options.drift.scale_error, &options.drift.translation_noise, &options.drift.rotation_noise_deg,
                        &options.drift.heading_drift_deg_per_100m})
    *error *= cell.settings.drift;
  options.num_threads = num_threads;
  const SyntheticFlight flight = write_synthetic_flight(folder, options);
  return flight.aliased.copies.empty() ? 0.0 : flight.aliased.share();
}

/// The folder of the cell's sequence, with its troubles.
fs::path prepare(const LabCell& cell, const LabDescription& description, const fs::path& scratch, int num_threads,
                 CellResult& result) {
  fs::path folder = cell.folder;
  if (description.synthetic) {
    folder = scratch / "world";
    result.aliased_share = render(*description.synthetic, cell, folder, num_threads);
  }
  if (is_trouble_free(cell.settings.trouble)) return folder;
  const fs::path troubled = scratch / "troubled";
  result.trouble = write_troubled_sequence(folder, troubled, cell.settings.trouble);
  if (description.synthetic) fs::remove_all(folder);
  return troubled;
}

std::vector<ObservedImage> times_of(const Sequence& sequence) {
  std::vector<ObservedImage> images(sequence.frames.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].frame = i;
    images[i].time_ns = sequence.frames[i].time_ns;
  }
  return images;
}

void read_truths(const fs::path& folder, const LabCell& cell, CellData& data) {
  RecognitionTruthOptions options;
  options.exclusion_window = static_cast<std::size_t>(cell.settings.window);
  options.poses.not_judged_radius_m = false_radius_m(options.poses, cell.height_above_ground_m);
  data.places = read_truth(folder, times_of(data.sequence), options);
  data.loops = read_loop_truth(folder);
  if (data.loops.world_from_camera.size() != data.sequence.frames.size())
    throw InputError((folder / "frames.csv").string() + ": has not as many frames as the sequence has images; list each once");
  for (const Frame& frame : data.sequence.frames) data.frame_times_ns.push_back(frame.time_ns);
  data.reference = reference_trajectory(data.sequence);
}

CellData look_at(const fs::path& folder, const LabCell& cell, const LabDescription& description, int num_threads) {
  CellData data;
  const fs::path odometry = folder / "odometry.tum";
  const bool has_odometry = fs::exists(odometry);
  if (!has_odometry && description.verifies())
    throw InputError(odometry.string() + ": is missing; without odometry only the stage 'appearance' can be judged");
  data.sequence = read_sequence(folder, {.odometry = has_odometry ? odometry : fs::path{}});
  read_truths(folder, cell, data);
  DescribedSequence described = describe_sequence(data.sequence, {.features = description.features, .num_threads = num_threads});
  // Only frames with odometry can be mapped, and all stages look at the same frames.
  std::erase_if(described.frames,
                [&](const DescribedFrame& frame) { return has_odometry && !data.sequence.frames[frame.frame].odom_from_camera; });
  data.frames = std::move(described.frames);
  if (data.frames.size() < 2) throw InputError(folder.string() + ": fewer than two images can be used");
  data.earlier = look_at_earlier(cell.earlier_folder, description.features, num_threads);
  // One model for all that is compared, as `fabloop map --earlier-map` needs it.
  const std::size_t num_earlier = data.earlier.frames.size();
  const auto features_of = [&](std::size_t i) {
    return i < num_earlier ? data.earlier.frames[i].features : data.frames[i - num_earlier].features;
  };
  data.model = train_own_model(num_earlier + data.frames.size(), features_of,
                               {.features = description.features, .num_threads = num_threads})
                   .model;
  if (description.verifies()) data.earlier_map = keyframes_of(data.earlier, data.model, num_threads);
  return data;
}

std::vector<ImageDigest> digest(const CellData& data, const LabDescription& description, int num_threads) {
  std::vector<PlaceMethod> methods;
  for (const LabMethod& method : description.methods) {
    if (method.method) methods.push_back(*method.method);
  }
  const ImageDigester digester(methods, &data.model);
  const std::size_t num_earlier = data.earlier.frames.size();
  std::vector<ImageDigest> digests(num_earlier + data.frames.size());
  parallel_for(digests.size(), num_threads, [&](std::size_t i) {
    const bool is_earlier = i < num_earlier;
    const Sequence& sequence = is_earlier ? data.earlier.sequence : data.sequence;
    const DescribedFrame& described = is_earlier ? data.earlier.frames[i] : data.frames[i - num_earlier];
    const Frame& frame = sequence.frames[described.frame];
    const cv::Mat gray = digester.needs_image() ? read_gray_image(frame.image_path, sequence.camera) : cv::Mat{};
    digests[i] = digester.digest(described.features, gray);
    digests[i].frame = described.frame + (is_earlier ? 0 : data.earlier.num_frames());
    digests[i].time_ns = frame.time_ns;
  });
  return digests;
}

ScoreTable scores_of(const LabMethod& method, const CellData& data, const std::vector<ImageDigest>& digests, const LabCell& cell,
                     const LabDescription& description, int num_threads) {
  PlaceScoreOptions options;
  options.num_recent_excluded = static_cast<std::size_t>(cell.settings.window);
  options.num_threads = num_threads;
  if (method.method) {
    ScoreTable table = score_sequence(*method.method, &data.model, digests, options);
    // Frames of the earlier flight are places, but nobody asks where they are.
    table.rows.erase(table.rows.begin(), table.rows.begin() + static_cast<std::ptrdiff_t>(data.earlier.frames.size()));
    return table;
  }
  std::vector<std::size_t> frames;
  for (const DescribedFrame& frame : data.frames) frames.push_back(frame.frame);
  ScoreTable table = empty_scores(frames, frames, true, options.num_recent_excluded);
  read_scores(scores_file(method, cell, description), table);
  return table;
}

}  // namespace

CellResult run_cell(const LabCell& cell, const LabDescription& description, const fs::path& scratch, int num_threads) {
  CellResult result;
  const fs::path folder = prepare(cell, description, scratch, num_threads, result);
  const CellData data = look_at(folder, cell, description, num_threads);
  result.num_frames = data.frames.size();
  result.odometry_ate_m = ate_of(odometry_trajectory(data.sequence), data.reference);
  const std::vector<ImageDigest> digests = digest(data, description, num_threads);
  for (const LabMethod& method : description.methods) {
    const ScoreTable scores = scores_of(method, data, digests, cell, description, num_threads);
    result.methods.push_back(run_method(method, scores, data, cell, description, scratch, num_threads));
  }
  return result;
}

}  // namespace fabloop
