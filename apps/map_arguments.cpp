// SPDX-License-Identifier: BSD-3-Clause
#include "apps/map_arguments.h"

namespace fabloop::apps {
namespace {

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
  add_live_argument(command, arguments.live);
}

void add_reconstruction_options(CLI::App* command, MapArguments& arguments) {
  command->add_flag("--from-images", arguments.from_images,
                    "structure from motion although there is odometry, which then gives the unit of length only");
  command->add_flag(
      "--without-loops", arguments.without_loops,
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
  command
      ->add_option("--rolling-shutter", arguments.rolling_shutter,
                   "without odometry: seconds from the first row of an image to the last, by its time stamps; estimate: as the "
                   "images tell; none: all rows at once")
      ->check(CLI::IsMember({"none", "estimate"}) | CLI::Number)
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
  command
      ->add_option("--max-error-px", loops.verifier.max_error_px,
                   "largest epipolar error of an inlier, in pixels of the image as its features were found")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--confirm", loops.consistency.num_required,
                   "believe a loop only when those of so many other images in a row agree with it; 0: at once")
      ->capture_default_str();
  command
      ->add_option(
          "--match-by", arguments.match_by,
          "with odometry: compare all features of two images, or those of one visual word, which is faster and misses some loops")
      ->check(CLI::IsMember({"features", "words"}))
      ->capture_default_str();
  command
      ->add_option(
          "--keyframe-windows", loops.window_size,
          "with odometry: a loop whose length no depth tells gets it from so many images around either side; 0, 1: none does")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "another number: other samples")->capture_default_str();
}

}  // namespace

void add_map_arguments(CLI::App* command, MapArguments& arguments) {
  add_input_options(command, arguments);
  add_reconstruction_options(command, arguments);
  add_method_options(command, arguments);
}

}  // namespace fabloop::apps
