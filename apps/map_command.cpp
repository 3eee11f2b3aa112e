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
#include "apps/feature_arguments.h"
#include "apps/progress_bar.h"
#include "apps/reconstruction_report.h"
#include "apps/report_page.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "posegraph/map_sequence.h"
#include "posegraph/run_folder.h"
#include "posegraph/sfm/reconstruct.h"
#include "posegraph/sfm/reconstruction_folder.h"

namespace fabloop::apps {
namespace {

struct MapArguments {
  std::string sequence;
  std::string odometry, reference, camera, model, out;
  std::string earlier_map, save_map;
  FeatureArguments features;
  std::string new_place = "mean-field", match_by = "features";
  double max_time_difference_s = 0.01;
  bool strict = false;
  bool overwrite = false;
  bool from_images = false;
  std::string gps, gps_use = "witness", refine = "nothing";
  double gps_sigma_m = GeoreferenceOptions{}.sigma_m;
  std::size_t gps_neighbours = 0;
  bool no_report = false;
  bool fresh = false;
  bool without_loops = false;
  MapSequenceOptions options;
};

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
  }
  input.images = sequence.frames.front().image_path.parent_path();
  input.num_threads = common.num_threads;
  write_report(input.truth.run / "report.html", input);
}

/// The map from images alone.
void run_reconstruct(const MapArguments& arguments, const CommonOptions& common, OutputFolder::IfExists if_exists) {
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
  take_positions(arguments, sequence, options);
  options.if_damaged = arguments.strict ? IfDamaged::Refuse : IfDamaged::Skip;
  options.num_threads = common.num_threads;
  options.seed = arguments.options.seed;
  options.warn = make_warn(common);
  options.progress = make_progress(common);
  options.also_without_loops = arguments.without_loops;
  options.state_folder = OutputFolder::part_path_of(arguments.out);
  if (arguments.fresh) options.if_state_found = WorkState::IfFound::Discard;
  const Reconstructed result = reconstruct(sequence, model, options);
  write_reconstruction_folder(arguments.out, sequence, result, options, if_exists);
  if (!arguments.no_report) write_report_of(arguments, sequence, common);
  print_reconstruction_report(std::cout, sequence, result, arguments.out);
}

void run_map(MapArguments& arguments, const CommonOptions& common) {
  const auto if_exists = arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse;
  OutputFolder::require_usable(arguments.out, if_exists);  // before the work, not after it
  if (arguments.odometry.empty() || arguments.from_images) return run_reconstruct(arguments, common, if_exists);
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
  options.progress = make_progress(common);
  options.earlier_map = arguments.earlier_map;
  options.mapper.save_map = arguments.save_map;
  if (!model && !common.quiet) {
    std::cout
        << "no --model: training one on the sequence itself (`fabloop train` on other flights gives better probabilities)\n";
  }
  const SequenceMap result = map_sequence(sequence, model, options);
  write_run_folder(arguments.out, sequence, result, options, if_exists);
  if (!arguments.no_report) write_report_of(arguments, sequence, common);
  print_run_report(std::cout, sequence, result, arguments.out);
}

void add_input_options(CLI::App* command, MapArguments& arguments) {
  command->add_option("SEQUENCE", arguments.sequence, "folder with the images (itself or in images/)")->required();
  command->add_option("--odometry", arguments.odometry,
                      "TUM file: t tx ty tz qx qy qz qw, world_from_camera (default: none; structure from motion)");
  command->add_option("--model", arguments.model, "model of `fabloop train` (default: train on the sequence itself)");
  command->add_option("--reference", arguments.reference, "TUM file to compare with (default: reference.tum in the folder)");
  command->add_option("--camera", arguments.camera, "calibration file (default: camera.yaml in the folder, else EXIF)");
  command->add_option("--out", arguments.out, "folder to write the run to")->required();
  command->add_option("--save-map", arguments.save_map, "file to keep the keyframes in for later flights, as they come");
  command->add_option("--earlier-map", arguments.earlier_map, "file of --save-map to look for loops in too; needs its --model");
  command->add_option("--max-time-difference", arguments.max_time_difference_s, "seconds between an image and its pose")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--strict", arguments.strict, "stop at an image that cannot be read instead of skipping it");
  command->add_flag("--overwrite", arguments.overwrite, "replace the folder if it exists");
  command->add_flag("--no-report", arguments.no_report, "do not write report.html");
}

void add_reconstruction_options(CLI::App* command, MapArguments& arguments) {
  command->add_flag("--from-images", arguments.from_images,
                    "structure from motion although there is odometry, which then gives the unit of length only");
  command->add_flag("--without-loops", arguments.without_loops,
                    "without odometry: make the map of neighbouring images alone, too, as trajectory_odometry.tum to compare with");
  command->add_flag("--fresh", arguments.fresh, "without odometry: forget what a stopped run left in OUT.part");
  command->add_option("--gps", arguments.gps,
                      "without odometry: lines filename,latitude,longitude,altitude (default: gps.csv in the folder, else EXIF)");
  command
      ->add_option("--gps-use", arguments.gps_use,
                   "witness: only to compare with; align: for unit, place and attitude; prior: also to straighten the map")
      ->check(CLI::IsMember({"witness", "align", "prior"}))
      ->capture_default_str();
  command->add_option("--gps-sigma", arguments.gps_sigma_m, "standard deviation of the GPS along each axis, metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--gps-neighbours", arguments.gps_neighbours, "compare each image with so many of the nearest by GPS, too")
      ->capture_default_str();
  command
      ->add_option("--refine", arguments.refine, "without odometry: what of the camera to refine where the images determine it")
      ->check(CLI::IsMember({"nothing", "focal", "focal-radial"}))
      ->capture_default_str();
}

void add_method_options(CLI::App* command, MapArguments& arguments) {
  MapSequenceOptions& options = arguments.options;
  LoopCloserOptions& loops = options.mapper.loops;
  add_feature_arguments(command, arguments.features, "as the model; without one, ");
  command->add_option("--hypotheses", loops.hypotheses.max_hypotheses, "how many places to verify for each image")
      ->capture_default_str();
  command->add_option("--min-probability", loops.hypotheses.min_probability, "verify only places at least so probable")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--window", loops.hypotheses.num_recent_excluded, "how many of the latest images are no loops")
      ->capture_default_str();
  command->add_option("--new-place", arguments.new_place, "likelihood of a new place; sampled needs a model of other places")
      ->check(CLI::IsMember({"mean-field", "sampled"}))
      ->capture_default_str();
  command->add_option("--min-inliers", loops.verifier.min_inliers, "least inliers of a loop")->capture_default_str();
  command->add_option("--max-error-px", loops.verifier.max_error_px, "largest epipolar error of an inlier")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--confirm", loops.consistency.num_required,
                   "believe a loop only when those of so many other images in a row agree with it; 0: at once")
      ->capture_default_str();
  command
      ->add_option("--match-by", arguments.match_by,
                   "features: compare all of two images; words: those of one visual word, which is faster and misses some loops")
      ->check(CLI::IsMember({"features", "words"}))
      ->capture_default_str();
  command
      ->add_option("--keyframe-windows", loops.window_size,
                   "a loop whose length no depth tells gets it from so many images around either side; 0: none does")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "another number: other samples")->capture_default_str();
}

}  // namespace

void add_map_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = program.add_subcommand("map", "Images in, with or without odometry; a map with its proven loops out");
  add_input_options(command, *arguments);
  add_reconstruction_options(command, *arguments);
  add_method_options(command, *arguments);
  command->callback([arguments, &common] { run_map(*arguments, common); });
}

}  // namespace fabloop::apps
