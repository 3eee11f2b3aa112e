// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model_training.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/domain_check.h"
#include "frontend/fabmap/held_out.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/training_images.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "frontend/features/feature_settings.h"

namespace fabloop {
namespace {

/// Everything that the model depends on besides the images, one thing a line.
std::string options_text(std::size_t num_images, const ModelTrainingOptions& options) {
  std::ostringstream text;
  text.precision(17);
  text << features_text(options.features) << "method " << static_cast<int>(options.method) << ' ' << options.num_words.value_or(0)
       << ' ' << options.radius << "\nmax descriptors " << options.max_descriptors << "\nseed " << options.seed << "\nimages "
       << num_images << '\n'
       << options.images_identity;
  return text.str();
}

/// One line an image: name, size and time of the file, not its folder.
std::string identity_of(const std::vector<Sequence>& sequences) {
  std::ostringstream text;
  for (const Sequence& sequence : sequences) {
    for (const Frame& frame : sequence.frames) text << file_identity(frame.image_path);
  }
  return text.str();
}

constexpr const char* kVocabularyFile = "vocabulary";
constexpr const char* kKMeansFile = "k-means";

std::optional<KMeansState> read_k_means(const WorkState& state) {
  std::optional<StateBytes> bytes = state.read(kKMeansFile);
  if (!bytes) return std::nullopt;
  KMeansState k_means;
  try {
    bytes->take(k_means.num_iterations);
    bytes->take(k_means.inertia);
    bytes->take(k_means.centres);
    bytes->take(k_means.assignment);
  } catch (const StateDamaged&) {
    state.warn_damaged(kKMeansFile);
    return std::nullopt;
  }
  return k_means;
}

void write_k_means(WorkState& state, const KMeansState& k_means) {
  StateBytes bytes;
  bytes.put(k_means.num_iterations);
  bytes.put(k_means.inertia);
  bytes.put(k_means.centres);
  bytes.put(k_means.assignment);
  state.write(kKMeansFile, bytes);
}

/// Tells where a former run stopped, if it had begun.
void tell_resumption(const WorkState& state, const Warn& warn) {
  if (!warn || !state.keeps()) return;
  std::string stage;
  if (state.has(kVocabularyFile)) {
    stage = "finding words";
  } else if (const auto k_means = state.has(kKMeansFile) ? read_k_means(state) : std::nullopt) {
    stage = "k-means, iteration " + std::to_string(k_means->num_iterations + 1) + ",";
  } else if (state.has("sample-00000")) {
    stage = "describing images";
  } else {
    return;
  }
  warn("resuming at " + stage + " of " + state.folder().string());
}

Vocabulary make_vocabulary(const cv::Mat& descriptors, const ModelTrainingOptions& options, WorkState& state) {
  if (options.method == VocabularyMethod::Radius) {
    RadiusClusteringOptions radius;
    radius.radius = options.radius;
    radius.seed = options.seed;
    radius.num_threads = options.num_threads;
    radius.progress = options.progress;
    return train_radius_clustering(descriptors, radius);
  }
  KMeansOptions k_means;
  k_means.num_words = options.num_words.value_or(default_num_words(static_cast<std::size_t>(descriptors.rows)));
  k_means.seed = options.seed;
  k_means.num_threads = options.num_threads;
  k_means.progress = options.progress;
  k_means.start = read_k_means(state);
  if (state.keeps()) k_means.after_iteration = [&](const KMeansState& now) { write_k_means(state, now); };
  return train_k_means(descriptors, k_means);
}

/// From the state, or made now and kept there.
Vocabulary train_vocabulary(const cv::Mat& descriptors, const ModelTrainingOptions& options, WorkState& state) {
  Vocabulary vocabulary;
  if (std::optional<StateBytes> bytes = state.read(kVocabularyFile)) {
    try {
      bytes->take(vocabulary.words);
      return vocabulary;
    } catch (const StateDamaged&) {
      state.warn_damaged(kVocabularyFile);
    }
  }
  vocabulary = make_vocabulary(descriptors, options, state);
  StateBytes bytes;
  bytes.put(vocabulary.words);
  state.write(kVocabularyFile, bytes);
  return vocabulary;
}

std::vector<Observation> observations_of(const std::vector<ImageWords>& words) {
  std::vector<Observation> observations;
  for (const ImageWords& image : words) observations.push_back(image.observation);
  return observations;
}

/// The model's health, and what its training set looks like.
TrainingReport report_on(Model& model, const std::vector<ImageWords>& words, const ModelTrainingOptions& options) {
  const std::vector<Observation> observations = observations_of(words);
  ChowLiuOptions tree_options = options.tree;
  tree_options.progress = {};
  const std::optional<HeldOut> held_out = hold_out(observations, model.vocabulary.num_words(), tree_options);
  if (held_out) model.domain = measure_domain(*held_out);
  std::vector<Observation> two_thirds;
  for (const ImageWords& image : words) two_thirds.push_back(image.two_thirds);
  SelfTestOptions test_options;
  test_options.detector = options.detector;
  test_options.seed = options.seed;
  TrainingReport report = count_words(observations, model.vocabulary.num_words());
  report.self_test = self_test(model.tree, observations, two_thirds, held_out, test_options);
  return report;
}

TrainedModel train(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options,
                   WorkState& state) {
  TrainedModel trained;
  Model& model = trained.model;
  model.features = options.features;
  model.detector = options.detector;
  TrainingImages images(num_images, features, options, state);
  cv::Mat sample = images.sample_descriptors();
  const auto num_descriptors = static_cast<std::size_t>(sample.rows);
  model.vocabulary = train_vocabulary(sample, options, state);
  const WordDistances distances = measure_distances(model.vocabulary, sample, options.num_threads);
  sample.release();
  const std::vector<ImageWords> words = images.find_words(model.vocabulary);
  ChowLiuOptions tree_options = options.tree;
  tree_options.progress = options.progress;
  ChowLiuResult tree = train_chow_liu_tree(observations_of(words), model.vocabulary.num_words(), tree_options);
  model.tree = std::move(tree.tree);
  for (const std::size_t image : sample_without_replacement(num_images, options.max_background, options.seed)) {
    model.background.push_back(words[image].observation);
  }
  model.provenance = {FABLOOP_VERSION, options.command, options.seed, num_images, num_descriptors};
  trained.report = report_on(model, words, options);
  trained.report.num_descriptors = num_descriptors;
  trained.report.mutual_information = tree.mutual_information;
  trained.report.entropy = tree.entropy;
  trained.report.distance_to_word = distances.to_word;
  trained.report.distance_between_words = distances.between_words;
  model.health = trained.report;
  return trained;
}

}  // namespace

std::string features_text(const FeatureOptions& features) {
  return std::string("fabloop ") + FABLOOP_VERSION + "\nfeatures " + feature_options_json(features) + '\n';
}

std::size_t default_num_words(std::size_t num_descriptors) { return std::clamp<std::size_t>(num_descriptors / 20, 1, 10000); }

TrainedModel train_model(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options) {
  if (num_images == 0) throw InputError("there are no images to train on");
  validate(options.detector, "detector");
  WorkState state;
  if (!options.state_folder.empty()) {
    state = WorkState(options.state_folder, "training", options_text(num_images, options), options.if_state_found, options.warn);
  }
  tell_resumption(state, options.warn);
  try {
    return train(num_images, features, options, state);
  } catch (const InputError&) {
    state.discard();  // it is of images or options that must change
    throw;
  }
}

TrainedModel train_model(const std::vector<Sequence>& sequences, const ModelTrainingOptions& options) {
  const FeatureExtractor extractor(options.features);
  std::vector<std::pair<std::size_t, std::size_t>> images;
  for (std::size_t sequence = 0; sequence < sequences.size(); ++sequence) {
    for (std::size_t frame = 0; frame < sequences[sequence].frames.size(); ++frame) images.emplace_back(sequence, frame);
  }
  const FeatureSource features = [&](std::size_t image) {
    const Sequence& sequence = sequences[images[image].first];
    return extractor.extract(read_gray_image(sequence.frames[images[image].second].image_path, sequence.camera));
  };
  ModelTrainingOptions identified = options;
  identified.images_identity += identity_of(sequences);
  return train_model(images.size(), features, identified);
}

}  // namespace fabloop
