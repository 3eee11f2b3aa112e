// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"
#include "frontend/sequence/keyframe_folder.h"

namespace fabloop::apps {
namespace {

struct KeyframesArguments {
  std::string source;
  std::string out;
  std::string camera;
  bool strict = false;
  bool overwrite = false;
  KeyframeFolderOptions options;
};

void run_keyframes(KeyframesArguments& arguments, const CommonOptions& common) {
  KeyframeFolderOptions& options = arguments.options;
  options.camera = arguments.camera;
  options.if_damaged = arguments.strict ? IfDamaged::Refuse : IfDamaged::Skip;
  options.if_exists = arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse;
  options.num_threads = common.num_threads;
  options.warn = make_warn(common);
  options.progress = make_progress(common);
  const KeyframeCount count = write_keyframe_folder(arguments.source, arguments.out, options);
  std::cout << arguments.out << ": " << count.num_keyframes << " keyframes of " << count.num_images << " images\n";
}

}  // namespace

void add_keyframes_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<KeyframesArguments>();
  CLI::App* command = program.add_subcommand(
      "keyframes",
      "Thin a video, or images at video rate, out to the images that show new ground: a sequence folder for the others");
  command->add_option("SOURCE", arguments->source, "video, or folder with the images (itself or in images/)")->required();
  command->add_option("--out", arguments->out, "folder to write images, times and what goes with them to")->required();
  command
      ->add_option("--max-overlap", arguments->options.choice.max_overlap,
                   "a keyframe is the first image that shares no more than this part of its area with the one before it")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  command->add_option("--camera", arguments->camera, "calibration file to go with them (default: camera.yaml in the folder)");
  command->add_flag("--strict", arguments->strict, "stop at an image that cannot be read instead of skipping it");
  command->add_flag("--overwrite", arguments->overwrite, "replace the folder if it exists");
  command->callback([arguments, &common] { run_keyframes(*arguments, common); });
}

}  // namespace fabloop::apps
