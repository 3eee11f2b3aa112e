// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/openfabmap_io.h"
#include "frontend/fabmap/openfabmap_settings.h"
#include "frontend/features/feature_settings.h"
#include "frontend/sequence/trajectory_formats.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/similarity_g2o_io.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

struct ConvertArguments {
  std::vector<std::string> inputs;
  std::string out;
  std::string trajectory_to;
  std::string graph_to;
  FeatureArguments features;
  std::uint64_t seed = 1;
  bool gzip = false;
  bool overwrite = false;
};

/// The files given, and those of the folders given.
std::vector<fs::path> input_files(const ConvertArguments& arguments) {
  std::vector<fs::path> files;
  for (const fs::path input : arguments.inputs) {
    if (!fs::is_directory(input)) {
      files.push_back(input);
      continue;
    }
    std::vector<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(input)) {
      if (entry.is_regular_file()) entries.push_back(entry.path());
    }
    std::sort(entries.begin(), entries.end());
    files.insert(files.end(), entries.begin(), entries.end());
  }
  return files;
}

struct OpenFabMapInputs {
  OpenFabMapFiles files;
  fs::path settings;
};

/// Which file is what, by what is in it.
OpenFabMapInputs sorted_inputs(const std::vector<fs::path>& files) {
  OpenFabMapInputs inputs;
  const auto set = [](fs::path& place, const fs::path& file, const char* what) {
    if (!place.empty()) throw InputError(file.string() + ": is a second " + what + " beside " + place.string() + "; give one");
    place = file;
  };
  for (const fs::path& file : files) {
    switch (openfabmap_file_kind(file)) {
      case OpenFabMapFile::Vocabulary:
        set(inputs.files.vocabulary, file, "vocabulary");
        break;
      case OpenFabMapFile::ChowLiuTree:
        set(inputs.files.tree, file, "Chow-Liu tree");
        break;
      case OpenFabMapFile::BowImages:
        set(inputs.files.images, file, "file of training images");
        break;
      case OpenFabMapFile::Settings:
        set(inputs.settings, file, "settings file");
        break;
    }
  }
  return inputs;
}

/// What was not given is where the settings say, when it is there.
void complete_from_settings(OpenFabMapInputs& inputs, const OpenFabMapSettings& settings) {
  const auto complete = [&](fs::path& place, const std::string& named) {
    if (named.empty()) return;
    const fs::path path = inputs.settings.parent_path() / named;
    if (place.empty() && fs::is_regular_file(path)) place = path;
  };
  complete(inputs.files.vocabulary, settings.vocabulary_path);
  complete(inputs.files.tree, settings.tree_path);
  complete(inputs.files.images, settings.training_images_path);
}

/// How openFABMAP describes images where its settings do not say otherwise: SIFT as OpenCV has it, contrast as it is.
FeatureOptions features_of_openfabmap(const fs::path& settings) {
  if (!settings.empty() && has_openfabmap_features(settings)) return read_openfabmap_features(settings);
  FeatureOptions features;
  features.root_sift = false;
  features.clahe_clip_limit.reset();
  return features;
}

void require_absent(const fs::path& path, bool overwrite) {
  if (fs::is_directory(path)) throw InputError(path.string() + ": is a folder; give a file name as --out");
  if (fs::exists(path) && !overwrite) {
    throw InputError(path.string() + ": exists already; choose another --out, or give --overwrite to replace it");
  }
}

void print_model(const std::string& out, const Model& model) {
  std::cout << out << ": " << model.vocabulary.num_words() << " words of " << model.vocabulary.words.cols << " numbers, "
            << model.background.size() << " background images\n";
}

void convert_to_model(const std::vector<fs::path>& files, const ConvertArguments& arguments, const CommonOptions& common) {
  require_absent(arguments.out, arguments.overwrite);
  OpenFabMapInputs inputs = sorted_inputs(files);
  OpenFabMapReadOptions options;
  options.features = asked_features(arguments.features, features_of_openfabmap(inputs.settings));
  options.seed = arguments.seed;
  options.warn = make_warn(common);
  OpenFabMapSettings settings;
  if (!inputs.settings.empty()) {
    settings = read_openfabmap_settings(inputs.settings, options.warn);
    complete_from_settings(inputs, settings);
    options.detector = settings.detector;
  }
  const std::string given = arguments.inputs.front();
  if (inputs.files.vocabulary.empty()) throw InputError(given + ": no file with a Vocabulary was given; a model needs one");
  if (inputs.files.tree.empty()) throw InputError(given + ": no file with a ChowLiuTree was given; a model needs one");
  Model model = read_openfabmap_model(inputs.files, options);
  if (settings.word_dependence == OpenFabMapSettings::WordDependence::NaiveBayes) model.tree = naive_bayes(model.tree);
  write_model(arguments.out, model);
  print_model(arguments.out, model);
}

void convert_to_openfabmap(const fs::path& file, const ConvertArguments& arguments) {
  const Model model = read_model(file);
  OpenFabMapWriteOptions options;
  if (arguments.gzip) options.compression = OpenFabMapWriteOptions::Compression::Gzip;
  if (arguments.overwrite) options.if_exists = OutputFolder::IfExists::Replace;
  write_openfabmap_model(arguments.out, model, options);
  print_model(arguments.out, model);
}

void convert_trajectory(const ConvertArguments& arguments) {
  if (arguments.inputs.size() != 1) throw InputError(arguments.inputs[1] + ": is a second input; give one trajectory");
  require_absent(arguments.out, arguments.overwrite);
  const fs::path in = arguments.inputs.front();
  const Trajectory trajectory = read_trajectory(in, detect_trajectory_format(in));
  write_trajectory(arguments.out, trajectory, *trajectory_format_named(arguments.trajectory_to));
  std::cout << arguments.out << ": " << trajectory.size() << " poses\n";
}

void convert_graph(const ConvertArguments& arguments, const CommonOptions& common) {
  if (arguments.inputs.size() != 1) throw InputError(arguments.inputs[1] + ": is a second input; give one graph");
  require_absent(arguments.out, arguments.overwrite);
  const fs::path in = arguments.inputs.front();
  G2oOptions options;
  options.warn = make_warn(common);
  if (has_similarities(in)) {
    if (arguments.graph_to == "toro") throw InputError(in.string() + ": has similarities, which TORO does not know");
    const SimilarityGraph graph = read_similarity_g2o(in, options);
    write_g2o(arguments.out, graph);
    std::cout << arguments.out << ": " << graph.vertices.size() << " vertices, " << graph.edges.size() << " edges\n";
    return;
  }
  const PoseGraph graph = read_g2o(in, options);
  arguments.graph_to == "toro" ? write_toro(arguments.out, graph) : write_g2o(arguments.out, graph);
  std::cout << arguments.out << ": " << graph.vertices.size() << " vertices, " << graph.edges.size() << " edges\n";
}

void run_convert(const ConvertArguments& arguments, const CommonOptions& common) {
  if (!arguments.trajectory_to.empty()) return convert_trajectory(arguments);
  if (!arguments.graph_to.empty()) return convert_graph(arguments, common);
  const std::vector<fs::path> files = input_files(arguments);
  if (files.empty()) throw InputError(arguments.inputs.front() + ": is an empty folder; give a model, or openFABMAP's files");
  const auto model = std::find_if(files.begin(), files.end(), is_model_file);
  if (model == files.end()) return convert_to_model(files, arguments, common);
  if (files.size() > 1) throw InputError(model->string() + ": is a model; give it alone to have openFABMAP's files made of it");
  convert_to_openfabmap(*model, arguments);
}

}  // namespace

void add_convert_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = program.add_subcommand(
      "convert", "openFABMAP's files into a model and back, or a trajectory or pose graph into another form");
  command
      ->add_option("IN", arguments->inputs,
                   "a model; or openFABMAP's vocabulary, tree and, optionally, training images (BOW) and settings, in any order, "
                   "or the folder of them")
      ->required();
  command->add_option("--out", arguments->out, "model file, folder for openFABMAP's files, or trajectory, to write")->required();
  command
      ->add_option("--trajectory-to", arguments->trajectory_to,
                   "IN is a trajectory (TUM, KITTI with times.txt beside it, or EuRoC): write it in this form")
      ->check(CLI::IsMember({"tum", "kitti", "euroc"}));
  command
      ->add_option("--graph-to", arguments->graph_to,
                   "IN is a pose graph (.g2o or TORO's lines): write it in this form, with vertices where it has none")
      ->check(CLI::IsMember({"g2o", "toro"}))
      ->excludes("--trajectory-to");
  add_feature_arguments(command, arguments->features, "to a model: as openFABMAP's settings file, else OpenCV's ");
  command->add_option("--seed", arguments->seed, "to a model: chooses among more than 1,000 training images")
      ->capture_default_str();
  command->add_flag("--gzip", arguments->gzip, "to openFABMAP: compress the matrices");
  command->add_flag("--overwrite", arguments->overwrite, "replace what exists");
  command->callback([arguments, &common] { run_convert(*arguments, common); });
}

}  // namespace fabloop::apps
