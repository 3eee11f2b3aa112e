// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "data/world_writer.h"

namespace fabloop::apps {
namespace {

struct SynthArguments {
  std::string scene = "meadow";
  std::string out;
  double drift = 1;  ///< Factor on every error of the odometry.
  bool depth = false;
  bool overwrite = false;
  SyntheticFlightOptions options;
};

void run_synth(SynthArguments& arguments, const CommonOptions& common) {
  arguments.options.num_threads = common.num_threads;
  arguments.options.progress = make_progress(common);
  auto& drift_options = arguments.options.drift;
  for (double* error : {&drift_options.scale_error, &drift_options.translation_noise, &drift_options.rotation_noise_deg,
                        &drift_options.heading_drift_deg_per_100m}) {
    *error *= arguments.drift;
  }
  arguments.options.depth_images = arguments.depth ? DepthImages::Written : DepthImages::None;
  const auto if_exists = arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse;
  const SyntheticFlight flight = write_synthetic_flight(arguments.out, arguments.options, if_exists);
  const Eigen::Vector3d drift = flight.odom_from_camera.back().translation - flight.world_from_camera.back().translation;
  std::cout << arguments.out << ": " << flight.world_from_camera.size() << " images over "
            << std::lround(arguments.options.flight.length_m) << " m; at the end the odometry is " << std::lround(drift.norm())
            << " m off\n";
}

}  // namespace

void add_synth_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<SynthArguments>();
  CLI::App* command = program.add_subcommand("synth", "Make a synthetic flight over a world whose truth is known");
  command->add_option("--scene", arguments->scene, "what is flown over")->check(CLI::IsMember({"meadow"}))->capture_default_str();
  command->add_option("--out", arguments->out, "folder to write the sequence into")->required();
  command->add_option("--seed", arguments->options.seed, "another number: another world, flight and odometry")
      ->capture_default_str();
  command->add_option("--length", arguments->options.flight.length_m, "length of the path, metres")->capture_default_str();
  command->add_option("--spacing", arguments->options.flight.spacing_m, "metres between images")->capture_default_str();
  command->add_option("--drift", arguments->drift, "how much the odometry errs: 0 not at all, 1 as a real one, 2 twice as much")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command
      ->add_option("--aliasing", arguments->options.aliasing.share,
                   "share of the ground that looks like other ground: copied squares, so that different places look the same")
      ->check(CLI::Range(0.0, 0.95))
      ->capture_default_str();
  command->add_flag("--depth", arguments->depth, "write depth images as well (16 bit, millimetres)");
  command->add_flag("--overwrite", arguments->overwrite, "replace the folder if it exists");
  command->callback([arguments, &common] { run_synth(*arguments, common); });
}

}  // namespace fabloop::apps
