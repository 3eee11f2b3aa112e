// SPDX-License-Identifier: BSD-3-Clause
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
#include "frontend/error.h"
#include "frontend/fabmap/model_training.h"

namespace fabloop::apps {
namespace {

struct TrainArguments {
  std::vector<std::string> sequences;
  std::string out;
  std::string camera;
  FeatureArguments features;
  std::string method = "kmeans";
  std::optional<std::size_t> num_words;
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
  text << " --seed " << arguments.options.seed;
  return text.str();
}

void print_summary(const std::string& out, const TrainingSummary& summary) {
  std::cout << out << ": " << summary.num_words << " words from " << summary.num_descriptors << " descriptors of "
            << summary.num_images << " images\n"
            << "words an image: " << std::lround(summary.mean_words_per_image) << " (" << summary.num_images_without_words
            << " images have none); words in one image only: " << summary.num_words_in_one_image << '\n'
            << "the tree keeps " << summary.mutual_information << " of the words' " << summary.entropy
            << " nats an image as mutual information\n";
}

void run_train(TrainArguments& arguments, const CommonOptions& common) {
  require_writable(arguments.out, arguments.overwrite);
  ModelTrainingOptions& options = arguments.options;
  options.features = asked_features(arguments.features);
  options.method = arguments.method == "radius" ? VocabularyMethod::Radius : VocabularyMethod::KMeans;
  options.num_words = arguments.num_words;
  options.num_threads = common.num_threads;
  options.command = canonical_command(arguments);
  SequenceOptions sequence_options;
  sequence_options.camera = arguments.camera;
  if (!common.quiet) sequence_options.warn = [](const std::string& message) { std::cerr << "note: " << message << '\n'; };
  std::vector<Sequence> sequences;
  for (const std::string& folder : arguments.sequences) sequences.push_back(read_sequence(folder, sequence_options));
  options.progress = make_progress(common);
  const TrainedModel trained = train_model(sequences, options);
  write_model(arguments.out, trained.model);
  print_summary(arguments.out, trained.summary);
}

}  // namespace

void add_train_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<TrainArguments>();
  ModelTrainingOptions& options = arguments->options;
  CLI::App* command = program.add_subcommand("train", "Learn the visual words of a kind of scene, and which are seen together");
  command->add_option("SEQUENCE", arguments->sequences, "folders of images like those to be recognised, best of other places")
      ->required();
  command->add_option("--out", arguments->out, "model file to write")->required();
  command->add_option("--camera", arguments->camera, "calibration file of all sequences (default: camera.yaml, else EXIF)");
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
  command->add_option("--seed", options.seed, "another number: another choice of descriptors")->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "replace the file if it exists");
  command->callback([arguments, &common] { run_train(*arguments, common); });
}

}  // namespace fabloop::apps
