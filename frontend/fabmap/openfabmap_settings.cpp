// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/openfabmap_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/openfabmap_storage.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

using Settings = OpenFabMapSettings;

/// openFABMAP's p(new place) with its motion model.
constexpr double kMotionPNew = 0.9;

/// Entries of a settings file by path ("openFabMapOptions.FabMapLUT.Precision"); remembers which of them were asked for.
class Entries {
 public:
  explicit Entries(const fs::path& path) : path_(path), storage_(open_storage(path)) {}

  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw InputError(path_.string() + ": " + name + " " + what);
  }

  double number(const std::string& name, double value_if_absent) {
    const cv::FileNode node = find(name);
    if (node.empty()) return value_if_absent;
    if (!node.isInt() && !node.isReal()) fail(name, "is not a number");
    return static_cast<double>(node);
  }

  std::size_t count(const std::string& name, std::size_t value_if_absent) {
    const double value = number(name, static_cast<double>(value_if_absent));
    constexpr double kMax = 1e9;
    if (!(value >= 0.0 && value <= kMax) || value != std::floor(value)) fail(name, "is not a whole number from 0 to 1e9");
    return static_cast<std::size_t>(value);
  }

  std::string text(const std::string& name) {
    const cv::FileNode node = find(name);
    if (node.empty()) return "";
    if (!node.isString()) fail(name, "is not a text");
    return static_cast<std::string>(node);
  }

  /// The value that a name stands for; the first one where there is no entry.
  template <typename T, std::size_t N>
  T choice(const std::string& name, const std::array<std::pair<const char*, T>, N>& choices) {
    const std::string chosen = text(name);
    if (chosen.empty()) return choices.front().second;
    std::string known;
    for (const auto& [label, value] : choices) {
      if (chosen == label) return value;
      known += (known.empty() ? "" : ", ") + std::string(label);
    }
    fail(name, "is \"" + chosen + "\"; openFABMAP knows " + known);
  }

  /// The entries that nobody asked for, without those of `FeatureOptions`.
  std::vector<std::string> unused() const {
    std::vector<std::string> names;
    collect_unused(storage_.root(), "", names);
    return names;
  }

 private:
  cv::FileNode find(const std::string& name) {
    used_.push_back(name);
    cv::FileNode node = storage_.root();
    std::istringstream path(name);
    for (std::string key; std::getline(path, key, '.');) {
      if (!node.isMap()) return {};
      node = node[key];
    }
    return node;
  }

  void collect_unused(const cv::FileNode& parent, const std::string& prefix, std::vector<std::string>& names) const {
    for (const cv::FileNode& node : parent) {
      const std::string name = prefix + node.name();
      if (name == "FeatureOptions") continue;
      if (node.isMap()) {
        collect_unused(node, name + ".", names);
      } else if (std::find(used_.begin(), used_.end(), name) == used_.end()) {
        names.push_back(name);
      }
    }
  }

  fs::path path_;
  cv::FileStorage storage_;
  std::vector<std::string> used_;
};

void read_recognition(Entries& entries, Settings& settings) {
  const std::string section = "openFabMapOptions.";
  settings.detector.p_seen_if_present = entries.number(section + "PzGe", settings.detector.p_seen_if_present);
  settings.detector.p_seen_if_absent = entries.number(section + "PzGne", settings.detector.p_seen_if_absent);
  settings.recognizer.engine = entries.choice<LikelihoodEngine>(
      section + "FabMapVersion",
      std::array{std::pair{"FABMAP2", LikelihoodEngine::InvertedIndex}, std::pair{"FABMAP1", LikelihoodEngine::Exact},
                 std::pair{"FABMAPLUT", LikelihoodEngine::Table}, std::pair{"FABMAPFBO", LikelihoodEngine::BailOut}});
  settings.recognizer.new_place = entries.choice<NewPlaceModel>(
      section + "NewPlaceMethod",
      std::array{std::pair{"Meanfield", NewPlaceModel::MeanField}, std::pair{"Sampled", NewPlaceModel::Sampled}});
  settings.recognizer.max_samples = entries.count(section + "NumSamples", settings.recognizer.max_samples);
  settings.word_dependence = entries.choice<Settings::WordDependence>(
      section + "BayesMethod", std::array{std::pair{"ChowLiu", Settings::WordDependence::ChowLiu},
                                          std::pair{"Naive", Settings::WordDependence::NaiveBayes}});
  if (entries.count(section + "SimpleMotion", 0) != 0) settings.motion = MotionModel{kMotionPNew, 0.5, 1, 0.5};
  settings.place_addition = entries.choice<Settings::PlaceAddition>(
      "FabMapPlaceAddition", std::array{std::pair{"All", Settings::PlaceAddition::All},
                                        std::pair{"NewMaximumOnly", Settings::PlaceAddition::NewMaximumOnly}});
}

void read_engines(Entries& entries, Settings& settings) {
  const std::string section = "openFabMapOptions.";
  settings.look_up_precision =
      static_cast<int>(entries.count(section + "FabMapLUT.Precision", static_cast<std::size_t>(settings.look_up_precision)));
  BailOutOptions& bail_out = settings.recognizer.bail_out;
  bail_out.negligible = entries.number(section + "FabMapFBO.RejectionThreshold", bail_out.negligible);
  bail_out.p_drop_best = entries.number(section + "FabMapFBO.PsGd", bail_out.p_drop_best);
  settings.bisection_start = entries.number(section + "FabMapFBO.BisectionStart", settings.bisection_start);
  settings.num_bisections =
      static_cast<int>(entries.count(section + "FabMapFBO.BisectionIts", static_cast<std::size_t>(settings.num_bisections)));
  bail_out.solver = BennettSolver::Bisection;
  try {
    validate(bail_out);
  } catch (const InputError&) {
    entries.fail(section + "FabMapFBO", "needs RejectionThreshold and PsGd between 0 and 1");
  }
}

void read_training(Entries& entries, Settings& settings) {
  settings.radius = entries.number("VocabTrainOptions.ClusterSize", settings.radius);
  if (!(settings.radius > 0.0)) entries.fail("VocabTrainOptions.ClusterSize", "must be larger than zero");
  settings.min_mutual_information = entries.number("ChowLiuOptions.LowerInfoBound", settings.min_mutual_information);
  if (!(settings.min_mutual_information >= 0.0)) entries.fail("ChowLiuOptions.LowerInfoBound", "must not be negative");
  settings.min_words_per_image = entries.count("BOWOptions.MinWords", settings.min_words_per_image);
  settings.vocabulary_path = entries.text("FilePaths.Vocabulary");
  settings.tree_path = entries.text("FilePaths.ChowLiuTree");
  settings.training_images_path = entries.text("FilePaths.TrainImagDesc");
}

}  // namespace

OpenFabMapSettings read_openfabmap_settings(const fs::path& path, const Warn& warn) {
  Entries entries(path);
  Settings settings;
  read_recognition(entries, settings);
  read_engines(entries, settings);
  read_training(entries, settings);
  validate(settings.detector, path.string() + ": PzGe and PzGne");
  const std::vector<std::string> unused = entries.unused();
  if (warn && !unused.empty()) {
    std::string names;
    for (const std::string& name : unused) names += (names.empty() ? "" : ", ") + name;
    warn(path.string() + ": not used: " + names);
  }
  return settings;
}

std::string openfabmap_settings_text(const Model& model, const std::string& matrix_extension) {
  std::ostringstream text;
  text.precision(17);
  text << "%YAML:1.0\n---\n"
       << "# The words are of fabloop's features: " << to_string(model.features.kind)
       << (model.features.root_sift ? " (RootSIFT)" : "") << ", at most " << model.features.max_features << " an image.\n"
       << "FilePaths:\n"
       << "   Vocabulary: \"vocabulary" << matrix_extension << "\"\n"
       << "   ChowLiuTree: \"tree" << matrix_extension << "\"\n"
       << (model.background.empty() ? "" : "   TrainImagDesc: \"bow" + matrix_extension + "\"\n")
       << "Function: \"RunOpenFABMAP\"\n"
       << "FabMapPlaceAddition: \"All\"\n"
       << "openFabMapOptions:\n"
       << "   PzGe: " << model.detector.p_seen_if_present << "\n   PzGne: " << model.detector.p_seen_if_absent << '\n'
       << "   NewPlaceMethod: \"" << (model.background.empty() ? "Meanfield" : "Sampled") << "\"\n"
       << "   NumSamples: " << std::max<std::size_t>(model.background.size(), 1) << '\n'
       << "   BayesMethod: \"ChowLiu\"\n"
       << "   SimpleMotion: 0\n"
       << "   FabMapVersion: \"" << (model.background.empty() ? "FABMAP1" : "FABMAP2") << "\"\n";
  return text.str();
}

}  // namespace fabloop
