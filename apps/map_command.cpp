// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/live_run.h"
#include "apps/map_arguments.h"
#include "apps/progress_bar.h"
#include "apps/reconstruction_report.h"
#include "apps/report_page.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/sequence/stamped_images.h"
#include "posegraph/map_sequence.h"
#include "posegraph/run/run_folder.h"
#include "posegraph/sfm/reconstruct.h"
#include "posegraph/sfm/reconstruction_folder.h"

namespace fabloop::apps {
namespace {

/// What the user asks for; the rest as the model has it, or by default. A model brings its own features, so asking for others
/// is an error.
FeatureOptions features_to_extract(const MapArguments& arguments, const std::optional<Model>& model) {
  const FeatureOptions asked = asked_features(arguments.features, model ? model->features : FeatureOptions{});
  if (!model) return asked;
  try {
    require_features(*model, asked);
  } catch (const InputError& error) {
    throw InputError(arguments.model + ": " + error.what());
  }
  return asked;
}

/// Before the work, not after it.
void require_usable_maps(const MapArguments& arguments) {
  namespace fs = std::filesystem;
  if (!arguments.earlier_map.empty() && arguments.model.empty()) {
    throw InputError(arguments.earlier_map + ": give the model that this map was made with, --model FILE");
  }
  if (arguments.save_map.empty() || !fs::exists(arguments.save_map)) return;
  if (arguments.earlier_map.empty() || !fs::equivalent(arguments.save_map, arguments.earlier_map)) {
    throw InputError(arguments.save_map + ": exists already; give it as --earlier-map too to go on with it, or remove it");
  }
}

/// Where the cameras are by GPS: a file, the sequence's own, or EXIF; or by the odometry, which has metres too.
void take_positions(const MapArguments& arguments, const Sequence& sequence, ReconstructOptions& options) {
  namespace fs = std::filesystem;
  if (!arguments.odometry.empty()) {
    for (const Frame& frame : sequence.frames) {
      options.known_positions.push_back(frame.odom_from_camera ? std::optional(frame.odom_from_camera->translation)
                                                               : std::nullopt);
    }
    options.position_use = PositionUse::Align;
    return;
  }
  const fs::path of_sequence = fs::path(arguments.sequence) / "gps.csv";
  const fs::path path = !arguments.gps.empty() ? fs::path(arguments.gps) : fs::exists(of_sequence) ? of_sequence : fs::path{};
  const auto positions = path.empty() ? gps_from_exif(sequence) : read_gps(path, sequence);
  if (std::none_of(positions.begin(), positions.end(), [](const auto& p) { return p.has_value(); })) return;
  const LocalPositions local = local_positions(positions);
  options.known_positions = local.east_north_up_m;
  options.origin = local.origin;
  options.georeference.sigma_m = arguments.gps_sigma_m;
  options.candidates.num_nearest = arguments.gps_neighbours;
  options.position_use = arguments.gps_use == "prior"   ? PositionUse::Prior
                         : arguments.gps_use == "align" ? PositionUse::Align
                                                        : PositionUse::Witness;
}

RollingShutterOptions rolling_shutter_of(const MapArguments& arguments) {
  if (arguments.rolling_shutter == "none") return {};
  if (arguments.rolling_shutter == "estimate") return {.shutter = Shutter::RollingEstimated};
  return {.shutter = Shutter::RollingKnown, .readout_s = std::stod(arguments.rolling_shutter)};
}

/// The page about the run, judged where the sequence has a truth.
void write_report_of(const MapArguments& arguments, const Sequence& sequence, const CommonOptions& common) {
  namespace fs = std::filesystem;
  const auto has_reference = [](const Frame& frame) { return frame.world_from_camera.has_value(); };
  ReportInput input;
  input.truth.run = arguments.out;
  if (std::any_of(sequence.frames.begin(), sequence.frames.end(), has_reference)) {
    input.truth.truth = arguments.reference.empty() ? fs::path(arguments.sequence) : fs::path(arguments.reference);
    input.truth.frames = input.truth.run / "frames.csv";
    input.truth.places.max_time_difference_s = arguments.max_time_difference_s;
    set_false_radius(input.truth, input.loops);
  }
  input.images = sequence.frames.front().image_path.parent_path();
  input.num_threads = common.num_threads;
  write_report(input.truth.run / "report.html", input);
}

/// The page, where one is wanted, and where it is.
std::filesystem::path report_of(const MapArguments& arguments, const Sequence& sequence, const CommonOptions& common,
                                const LiveRun& live) {
  if (arguments.no_report) return {};
  live.begin_stage("report");
  write_report_of(arguments, sequence, common);
  return std::filesystem::path(arguments.out) / "report.html";
}

/// The map from images alone. Returns where its report is.
std::filesystem::path run_reconstruct(const MapArguments& arguments, const CommonOptions& common,
                                      OutputFolder::IfExists if_exists, const LiveRun& live) {
  const Sequence sequence = read_sequence(arguments.sequence, {.camera = arguments.camera,
                                                               .odometry = arguments.odometry,
                                                               .reference = arguments.reference,
                                                               .max_time_difference_s = arguments.max_time_difference_s,
                                                               .warn = make_warn(common)});
  std::optional<Model> model;
  if (!arguments.model.empty()) model = read_model(arguments.model);
  ReconstructOptions options;
  options.features =
      model ? features_to_extract(arguments, model) : asked_features(arguments.features, reconstruction_features());
  options.refine = arguments.refine == "focal"          ? RefineCamera::Focal
                   : arguments.refine == "focal-radial" ? RefineCamera::FocalRadial
                                                        : RefineCamera::Nothing;
  options.rolling_shutter = rolling_shutter_of(arguments);
  take_positions(arguments, sequence, options);
  options.if_damaged = arguments.strict ? IfDamaged::Refuse : IfDamaged::Skip;
  options.num_threads = common.num_threads;
  options.seed = arguments.options.seed;
  options.warn = make_warn(common);
  options.progress = live.progress(make_progress(common));
  options.watch = live.watch_placed();
  options.also_without_loops = arguments.without_loops;
  options.state_folder = OutputFolder::part_path_of(arguments.out);
  if (arguments.fresh) options.if_state_found = WorkState::IfFound::Discard;
  const Reconstructed result = reconstruct(sequence, model, options);
  write_reconstruction_folder(arguments.out, sequence, result, options, if_exists);
  const std::filesystem::path report = report_of(arguments, sequence, common, live);
  print_reconstruction_report(std::cout, sequence, result, arguments.out);
  return report;
}

/// The map with odometry. Returns where its report is.
std::filesystem::path run_with_odometry(MapArguments& arguments, const CommonOptions& common, OutputFolder::IfExists if_exists,
                                        const LiveRun& live) {
  { const OutputFolder probe(arguments.out, if_exists); }  // that it can be written
  require_usable_maps(arguments);
  SequenceOptions sequence_options{.camera = arguments.camera,
                                   .odometry = arguments.odometry,
                                   .reference = arguments.reference,
                                   .max_time_difference_s = arguments.max_time_difference_s,
                                   .warn = make_warn(common)};
  const Sequence sequence = read_sequence(arguments.sequence, sequence_options);
  std::optional<Model> model;
  MapSequenceOptions& options = arguments.options;
  if (!arguments.model.empty()) model = read_model(arguments.model);
  options.features = features_to_extract(arguments, model);
  options.mapper.loops.recognizer.new_place =
      arguments.new_place == "sampled" ? NewPlaceModel::Sampled : NewPlaceModel::MeanField;
  options.mapper.loops.verifier.match_by = arguments.match_by == "words" ? MatchBy::Words : MatchBy::Features;
  options.if_damaged = arguments.strict ? IfDamaged::Refuse : IfDamaged::Skip;
  options.num_threads = common.num_threads;
  options.warn = make_warn(common);
  options.progress = live.progress(make_progress(common));
  options.watch = live.watch_map();
  options.earlier_map = arguments.earlier_map;
  options.mapper.save_map = arguments.save_map;
  if (!model && !common.quiet) {
    std::cout
        << "no --model: training one on the sequence itself (`fabloop train` on other flights gives better probabilities)\n";
  }
  const SequenceMap result = map_sequence(sequence, model, options);
  write_run_folder(arguments.out, sequence, result, options, if_exists);
  const std::filesystem::path report = report_of(arguments, sequence, common, live);
  print_run_report(std::cout, sequence, result, arguments.out);
  return report;
}

void run_map(MapArguments& arguments, const CommonOptions& common) {
  const auto if_exists = arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse;
  OutputFolder::require_usable(arguments.out, if_exists);  // before the work, not after it
  LiveRun live(arguments.live, sequence_name(arguments.sequence), arguments.out);
  live.until_end_of([&] {
    if (arguments.odometry.empty() || arguments.from_images) return run_reconstruct(arguments, common, if_exists, live);
    return run_with_odometry(arguments, common, if_exists, live);
  });
}

}  // namespace

void add_map_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = program.add_subcommand("map", "Images in, with or without odometry; a map with its proven loops out");
  add_map_arguments(command, *arguments);
  command->callback([arguments, &common] { run_map(*arguments, common); });
}

}  // namespace fabloop::apps
