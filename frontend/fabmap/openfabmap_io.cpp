// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/openfabmap_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "frontend/error.h"
#include "frontend/fabmap/openfabmap_settings.h"
#include "frontend/fabmap/openfabmap_storage.h"
#include "frontend/fabmap/sampling.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVocabulary = "Vocabulary";
constexpr const char* kTree = "ChowLiuTree";
constexpr const char* kImages = "BOWImageDescs";
constexpr int kTreeRows = 4;
constexpr double kMinProbability = 1e-4;

[[noreturn]] void fail(const fs::path& path, const std::string& what) { throw InputError(path.string() + ": " + what); }

/// Moves probabilities to where logarithms are finite, and counts what it moves.
class ProbabilityMender {
 public:
  explicit ProbabilityMender(const fs::path& path) : path_(path) {}

  double marginal(double p, int word) {
    if (!(p >= 0.0 && p <= 1.0)) {
      fail(path_, "word " + std::to_string(word) + " has probability " + std::to_string(p) +
                      ", which must lie between 0 and 1; train the tree again");
    }
    if (p >= kMinProbability && p <= 1.0 - kMinProbability) return p;
    ++num_moved;
    return std::clamp(p, kMinProbability, 1.0 - kMinProbability);
  }

  double conditional(double p, double marginal_p, int word) {
    if (!std::isnan(p)) return marginal(p, word);
    ++num_not_a_number;
    return marginal_p;
  }

  void tell(const Warn& warn) const {
    if (!warn || num_moved + num_not_a_number == 0) return;
    warn(path_.string() + ": " + std::to_string(num_moved) + " probabilities of 0 or 1 were moved inside by " +
         std::to_string(kMinProbability) + ", and " + std::to_string(num_not_a_number) +
         " that are not numbers were replaced by the word's own");
  }

 private:
  const fs::path& path_;
  std::size_t num_moved = 0, num_not_a_number = 0;
};

/// The parent of a word; none for a root, which is its own parent (or, in other trainers' files, has none: -1).
std::optional<WordId> parent_of(const fs::path& path, double parent, int word, int num_words) {
  if (parent == word || parent == -1.0) return std::nullopt;
  if (parent >= 0.0 && parent < num_words && parent == std::floor(parent)) return static_cast<WordId>(parent);
  fail(path, "word " + std::to_string(word) + " has parent " + std::to_string(parent) + " but there are only " +
                 std::to_string(num_words) + " words; train the tree again");
}

/// How many numbers a descriptor of these features has, as vocabularies take them: found out by describing noise. None when
/// nothing is found in it.
std::optional<int> descriptor_length(const FeatureOptions& features) {
  cv::Mat noise(240, 320, CV_8UC1);
  cv::RNG random(1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::resize(noise(cv::Rect(0, 0, 80, 60)), noise, noise.size(), 0, 0, cv::INTER_CUBIC);
  const cv::Mat descriptors = float_descriptors(FeatureExtractor(features).extract(noise).descriptors);
  return descriptors.empty() ? std::nullopt : std::optional(descriptors.cols);
}

void require_same_words(const fs::path& path, std::size_t num_words, const fs::path& vocabulary, std::size_t expected) {
  if (num_words == expected) return;
  fail(path, "is about " + std::to_string(num_words) + " words, but " + vocabulary.string() + " has " + std::to_string(expected) +
                 "; give files of one training");
}

void require_length_of_features(const fs::path& path, const Vocabulary& vocabulary, const FeatureOptions& features) {
  const std::optional<int> length = descriptor_length(features);
  if (!length || *length == vocabulary.words.cols) return;
  fail(path, "has words of " + std::to_string(vocabulary.words.cols) + " numbers, but " + std::string(to_string(features.kind)) +
                 " descriptors have " + std::to_string(*length) + "; say which features they were made of (--features)");
}

cv::Mat tree_matrix(const ChowLiuTree& tree) {
  cv::Mat matrix(kTreeRows, static_cast<int>(tree.num_words()), CV_64F);
  for (int word = 0; word < matrix.cols; ++word) {
    const ChowLiuNode& node = tree.nodes[static_cast<std::size_t>(word)];
    const std::array<double, kTreeRows> column = {static_cast<double>(node.parent.value_or(static_cast<WordId>(word))), node.p,
                                                  node.p_if_parent, node.p_if_no_parent};
    for (int row = 0; row < kTreeRows; ++row) matrix.at<double>(row, word) = column[static_cast<std::size_t>(row)];
  }
  return matrix;
}

cv::Mat images_matrix(const std::vector<Observation>& images, std::size_t num_words) {
  cv::Mat matrix = cv::Mat::zeros(static_cast<int>(images.size()), static_cast<int>(num_words), CV_32F);
  for (int image = 0; image < matrix.rows; ++image) {
    for (const WordId word : images[static_cast<std::size_t>(image)].words) matrix.at<float>(image, static_cast<int>(word)) = 1;
  }
  return matrix;
}

}  // namespace

OpenFabMapFile openfabmap_file_kind(const fs::path& path) {
  const cv::FileStorage storage = open_storage(path);
  if (!storage[kVocabulary].empty()) return OpenFabMapFile::Vocabulary;
  if (!storage[kTree].empty()) return OpenFabMapFile::ChowLiuTree;
  if (!storage[kImages].empty()) return OpenFabMapFile::BowImages;
  if (!storage["openFabMapOptions"].empty() || !storage["FeatureOptions"].empty()) return OpenFabMapFile::Settings;
  fail(path, "is none of openFABMAP's files: no Vocabulary, ChowLiuTree, BOWImageDescs or openFabMapOptions in it");
}

Vocabulary read_openfabmap_vocabulary(const fs::path& path) {
  Vocabulary vocabulary{read_storage_matrix(path, kVocabulary, CV_32FC1)};
  if (!cv::checkRange(vocabulary.words)) fail(path, "Vocabulary has entries that are not finite numbers; train it again");
  return vocabulary;
}

ChowLiuTree read_openfabmap_tree(const fs::path& path, const Warn& warn) {
  const cv::Mat matrix = read_storage_matrix(path, kTree, CV_64FC1);
  if (matrix.rows != kTreeRows) {
    fail(path, "ChowLiuTree has " + std::to_string(matrix.rows) + " rows where openFABMAP has 4; is it transposed?");
  }
  ChowLiuTree tree;
  ProbabilityMender mender(path);
  for (int word = 0; word < matrix.cols; ++word) {
    const double p = mender.marginal(matrix.at<double>(1, word), word);
    const auto parent = parent_of(path, matrix.at<double>(0, word), word, matrix.cols);
    if (!parent) {
      tree.nodes.push_back({std::nullopt, p, p, p});
    } else {
      tree.nodes.push_back({parent, p, mender.conditional(matrix.at<double>(2, word), p, word),
                            mender.conditional(matrix.at<double>(3, word), p, word)});
    }
  }
  parents_first(tree, path.string());
  mender.tell(warn);
  return tree;
}

OpenFabMapImages read_openfabmap_images(const fs::path& path) {
  const cv::Mat matrix = read_storage_matrix(path, kImages, CV_32FC1);
  if (!cv::checkRange(matrix)) fail(path, "BOWImageDescs has entries that are not finite numbers; make it again");
  OpenFabMapImages images{static_cast<std::size_t>(matrix.cols), {}};
  images.observations.resize(static_cast<std::size_t>(matrix.rows));
  for (int image = 0; image < matrix.rows; ++image) {
    const auto* row = matrix.ptr<float>(image);
    for (int word = 0; word < matrix.cols; ++word) {
      if (row[word] > 0.0f) images.observations[static_cast<std::size_t>(image)].words.push_back(static_cast<WordId>(word));
    }
  }
  return images;
}

Model read_openfabmap_model(const OpenFabMapFiles& files, const OpenFabMapReadOptions& options) {
  Model model;
  model.features = options.features;
  model.detector = options.detector;
  model.vocabulary = read_openfabmap_vocabulary(files.vocabulary);
  require_length_of_features(files.vocabulary, model.vocabulary, options.features);
  model.tree = read_openfabmap_tree(files.tree, options.warn);
  require_same_words(files.tree, model.tree.num_words(), files.vocabulary, model.vocabulary.num_words());
  if (!files.images.empty()) {
    const OpenFabMapImages images = read_openfabmap_images(files.images);
    require_same_words(files.images, images.num_words, files.vocabulary, model.vocabulary.num_words());
    model.provenance.num_images = images.observations.size();
    for (const std::size_t image : sample_without_replacement(images.observations.size(), options.max_background, options.seed)) {
      model.background.push_back(images.observations[image]);
    }
  }
  model.provenance.fabloop_version = FABLOOP_VERSION;
  model.provenance.command = "convert from openFABMAP";
  model.provenance.seed = options.seed;
  validate(model, files.vocabulary.string());
  return model;
}

void write_openfabmap_model(const fs::path& folder, const Model& model, const OpenFabMapWriteOptions& options) {
  validate(model, folder.string());
  OutputFolder output(folder, options.if_exists);
  const std::string extension = options.compression == OpenFabMapWriteOptions::Compression::Gzip ? ".yml.gz" : ".yml";
  const auto path = [&](const char* name) { return output.part_path() / (name + extension); };
  write_storage_matrix(path("vocabulary"), kVocabulary, model.vocabulary.words);
  write_storage_matrix(path("tree"), kTree, tree_matrix(model.tree));
  if (!model.background.empty()) {
    write_storage_matrix(path("bow"), kImages, images_matrix(model.background, model.tree.num_words()));
  }
  OutputFile settings(output.part_path() / "settings.yml");
  settings.stream() << openfabmap_settings_text(model, extension);
  settings.commit();
  output.commit();
}

}  // namespace fabloop
