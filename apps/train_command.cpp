// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/fabmap/source_training.h"
#include "frontend/fabmap/training_report.h"
#include "frontend/output_file.h"

namespace fabloop::apps {
namespace {

struct TrainArguments {
  std::vector<std::string> sequences;
  std::string out;
  std::string camera;
  FeatureArguments features;
  std::string method = "kmeans";
  std::optional<std::size_t> num_words;
  ImageSourceOptions source{.if_damaged = IfDamaged::Refuse};
  bool panorama = false;
  std::string report;
  bool fresh = false;
  bool overwrite = false;
  ModelTrainingOptions options;
};

/// Before the work, not after it: the model can be written where it is wanted.
void require_writable(const std::filesystem::path& path, bool overwrite) {
  if (std::filesystem::is_directory(path)) throw InputError(path.string() + ": is a folder; give a file name as --out");
  if (std::filesystem::exists(path) && !overwrite) {
    throw InputError(path.string() + ": exists already; choose another --out, or give --overwrite to replace it");
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder))
    throw InputError(folder.string() + ": no such folder; create it, or choose another --out");
}

/// The options that decide what the model is, without paths, so that the same training gives the same file anywhere.
std::string canonical_command(const TrainArguments& arguments) {
  std::ostringstream text;
  text << "train --features " << to_string(arguments.options.features.kind) << " --max-features "
       << arguments.options.features.max_features << " --method " << arguments.method;
  if (arguments.num_words) text << " --words " << *arguments.num_words;
  if (arguments.options.method == VocabularyMethod::Radius) text << " --radius " << arguments.options.radius;
  if (arguments.options.tree.min_mutual_information) {
    text << " --min-mutual-information " << *arguments.options.tree.min_mutual_information;
  }
  if (arguments.source.every > 1) text << " --every " << arguments.source.every;
  if (arguments.source.max_images_per_s) text << " --rate " << *arguments.source.max_images_per_s;
  if (arguments.panorama) text << " --panorama";
  text << " --seed " << arguments.options.seed;
  return text.str();
}

const char* mark_of(Grade grade) {
  switch (grade) {
    case Grade::Good:
      return "  ";
    case Grade::Fair:
      return "- ";
    case Grade::Poor:
      return "! ";
  }
  return "";
}

void print_report(const std::string& out, const TrainingReport& report) {
  std::cout << out << ": " << report.num_words << " words from " << report.num_descriptors << " descriptors of "
            << report.num_images << " images\n";
  for (const Finding& finding : findings(report)) {
    std::cout << mark_of(finding.grade) << finding.figure << ": " << finding.verdict << '\n';
  }
}

void write_report(const std::string& path, const TrainingReport& report) {
  OutputFile file(path);
  file.stream() << to_json_with_findings(report);
  file.commit();
}

/// The model appears under its name when it is complete, and only then is the state given up.
void write_and_remove_state(const std::filesystem::path& out, const std::filesystem::path& state, const Model& model) {
  if (!std::filesystem::is_directory(state)) return write_model(out, model);
  write_model(state / "model", model);
  std::error_code error;
  std::filesystem::rename(state / "model", out, error);
  if (error) throw InputError(out.string() + ": cannot be written (" + error.message() + "); choose another --out");
  std::filesystem::remove_all(state, error);
}

/// Whether the images must be taken one after the other instead of at will.
bool needs_sources(const TrainArguments& arguments) {
  if (arguments.panorama || arguments.source.every > 1 || arguments.source.max_images_per_s) return true;
  return std::any_of(arguments.sequences.begin(), arguments.sequences.end(),
                     [](const std::string& path) { return std::filesystem::is_regular_file(path); });
}

TrainedModel train_on_sources(const TrainArguments& arguments) {
  SourceTrainingOptions options{arguments.source, arguments.panorama ? ImageShape::Panorama : ImageShape::Plain};
  options.source.num_threads = arguments.options.num_threads;
  options.source.warn = arguments.options.warn;
  return train_model({arguments.sequences.begin(), arguments.sequences.end()}, options, arguments.options);
}

TrainedModel train_on_sequences(const TrainArguments& arguments) {
  std::vector<Sequence> sequences;
  for (const std::string& folder : arguments.sequences) {
    sequences.push_back(read_sequence(folder, {.camera = arguments.camera, .warn = arguments.options.warn}));
  }
  return train_model(sequences, arguments.options);
}

void run_train(TrainArguments& arguments, const CommonOptions& common) {
  require_writable(arguments.out, arguments.overwrite);
  ModelTrainingOptions& options = arguments.options;
  options.features = asked_features(arguments.features);
  options.method = arguments.method == "radius" ? VocabularyMethod::Radius : VocabularyMethod::KMeans;
  options.num_words = arguments.num_words;
  options.num_threads = common.num_threads;
  options.command = canonical_command(arguments);
  options.progress = make_progress(common);
  options.warn = make_warn(common);
  options.state_folder = arguments.out + ".part";
  if (arguments.fresh) options.if_state_found = WorkState::IfFound::Discard;
  const TrainedModel trained = needs_sources(arguments) ? train_on_sources(arguments) : train_on_sequences(arguments);
  write_and_remove_state(arguments.out, options.state_folder, trained.model);
  if (!arguments.report.empty()) write_report(arguments.report, trained.report);
  print_report(arguments.out, trained.report);
}

}  // namespace

void add_train_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<TrainArguments>();
  ModelTrainingOptions& options = arguments->options;
  CLI::App* command = program.add_subcommand("train", "Learn the visual words of a kind of scene, and which are seen together");
  command
      ->add_option("SEQUENCE", arguments->sequences,
                   "folders of images like those to be recognised, or videos, best of other places")
      ->required();
  command->add_option("--out", arguments->out, "model file to write")->required();
  command->add_option("--camera", arguments->camera, "calibration file of all sequences (default: camera.yaml, else EXIF)");
  command->add_option("--every", arguments->source.every, "take only every Nth image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rate", arguments->source.max_images_per_s, "take at most so many images a second of the sequence's time")
      ->check(CLI::PositiveNumber);
  command->add_flag("--panorama", arguments->panorama, "the images show 360 degrees: their left and right edges are neighbours");
  add_feature_arguments(command, arguments->features, "");
  command->add_option("--method", arguments->method, "how descriptors become words")
      ->check(CLI::IsMember({"kmeans", "radius"}))
      ->capture_default_str();
  CLI::Option* words =
      command->add_option("--words", arguments->num_words, "number of words for kmeans (default: by the amount of data)")
          ->check(CLI::PositiveNumber);
  command->add_option("--radius", options.radius, "how far apart words are, for radius: distance between descriptors")
      ->check(CLI::PositiveNumber)
      ->excludes(words);
  command
      ->add_option("--min-mutual-information", options.tree.min_mutual_information,
                   "least nats that a link of the tree tells; 0 keeps all (default: more than chance would)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seed", options.seed, "another number: another choice of descriptors")->capture_default_str();
  command->add_option("--report", arguments->report, "JSON file to write the health report to");
  command->add_flag("--fresh", arguments->fresh, "forget what a stopped run of this training left in OUT.part");
  command->add_flag("--overwrite", arguments->overwrite, "replace the file if it exists");
  command->callback([arguments, &common] { run_train(*arguments, common); });
}

}  // namespace fabloop::apps
