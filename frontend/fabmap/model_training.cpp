// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model_training.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Images looked at between two reports of progress.
constexpr std::size_t kBlockSize = 32;

using ImageBody = std::function<void(std::size_t image)>;

/// parallel_for over all images in blocks. After each block, this thread reports progress and calls `finish` in order.
void for_each_image(std::size_t num_images, std::string_view stage, const ModelTrainingOptions& options, const ImageBody& body,
                    const ImageBody& finish) {
  for (std::size_t begin = 0; begin < num_images; begin += kBlockSize) {
    const std::size_t end = std::min(begin + kBlockSize, num_images);
    parallel_for(end - begin, options.num_threads, [&](std::size_t i) { body(begin + i); });
    for (std::size_t image = begin; image < end; ++image) finish(image);
    if (options.progress) options.progress(stage, end, num_images);
  }
}

/// What the first look at the images leaves.
struct FirstLook {
  std::vector<std::optional<cv::Mat>> descriptors;  ///< Of each image, as extracted, where they were kept.
  cv::Mat sample;                                   ///< N x D, CV_32F: the same share of every image.
};

cv::Mat sampled_rows(const cv::Mat& descriptors, std::size_t wanted, std::uint64_t seed) {
  cv::Mat result;
  for (const std::size_t row : sample_without_replacement(static_cast<std::size_t>(descriptors.rows), wanted, seed)) {
    result.push_back(descriptors.row(static_cast<int>(row)));
  }
  return float_descriptors(result);
}

FirstLook look_at_images(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options) {
  const std::size_t share = (options.max_descriptors + num_images - 1) / num_images;
  FirstLook look{std::vector<std::optional<cv::Mat>>(num_images), {}};
  std::vector<cv::Mat> samples(num_images);
  std::size_t kept_bytes = 0;
  const auto describe = [&](std::size_t image) {
    look.descriptors[image] = features(image).descriptors;
    samples[image] = sampled_rows(*look.descriptors[image], share, options.seed + image);
  };
  const auto keep_if_it_fits = [&](std::size_t image) {
    const std::size_t bytes = look.descriptors[image]->total() * look.descriptors[image]->elemSize();
    if (kept_bytes + bytes <= options.max_kept_bytes) {
      kept_bytes += bytes;
    } else {
      look.descriptors[image].reset();
    }
    if (!samples[image].empty()) look.sample.push_back(samples[image]);
    samples[image].release();
  };
  for_each_image(num_images, "describing images", options, describe, keep_if_it_fits);
  return look;
}

Vocabulary train_vocabulary(const cv::Mat& descriptors, const ModelTrainingOptions& options) {
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
  return train_k_means(descriptors, k_means);
}

std::vector<Observation> observe_images(const Vocabulary& vocabulary, FirstLook look, const FeatureSource& features,
                                        const ModelTrainingOptions& options) {
  std::vector<Observation> observations(look.descriptors.size());
  const WordFinder words(vocabulary);
  const auto observe_image = [&](std::size_t image) {
    const auto& kept = look.descriptors[image];
    observations[image] = words.observe(kept ? *kept : features(image).descriptors);
    look.descriptors[image].reset();
  };
  for_each_image(observations.size(), "finding words", options, observe_image, [](std::size_t) {});
  return observations;
}

TrainingSummary summarize(const std::vector<Observation>& observations, std::size_t num_words, const ChowLiuResult& tree) {
  TrainingSummary summary;
  summary.num_images = observations.size();
  summary.num_words = num_words;
  summary.mutual_information = tree.mutual_information;
  summary.entropy = tree.entropy;
  std::vector<std::size_t> images(num_words, 0);
  for (const Observation& observation : observations) {
    if (observation.words.empty()) ++summary.num_images_without_words;
    summary.mean_words_per_image += static_cast<double>(observation.words.size());
    for (const WordId word : observation.words) ++images[word];
  }
  summary.mean_words_per_image /= static_cast<double>(observations.size());
  summary.num_words_in_one_image = static_cast<std::size_t>(std::count(images.begin(), images.end(), std::size_t{1}));
  return summary;
}

}  // namespace

std::size_t default_num_words(std::size_t num_descriptors) { return std::clamp<std::size_t>(num_descriptors / 50, 1, 2000); }

TrainedModel train_model(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options) {
  if (num_images == 0) throw InputError("there are no images to train on");
  validate(options.detector, "detector");
  FirstLook look = look_at_images(num_images, features, options);
  const auto num_descriptors = static_cast<std::size_t>(look.sample.rows);

  TrainedModel trained;
  Model& model = trained.model;
  model.features = options.features;
  model.detector = options.detector;
  model.vocabulary = train_vocabulary(look.sample, options);
  look.sample.release();
  const std::vector<Observation> observations = observe_images(model.vocabulary, std::move(look), features, options);
  ChowLiuOptions tree_options = options.tree;
  tree_options.progress = options.progress;
  ChowLiuResult tree = train_chow_liu_tree(observations, model.vocabulary.num_words(), tree_options);
  for (const std::size_t image : sample_without_replacement(num_images, options.max_background, options.seed)) {
    model.background.push_back(observations[image]);
  }
  model.provenance = {FABLOOP_VERSION, options.command, options.seed, num_images, num_descriptors};
  trained.summary = summarize(observations, model.vocabulary.num_words(), tree);
  trained.summary.num_descriptors = num_descriptors;
  model.tree = std::move(tree.tree);
  return trained;
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
  return train_model(images.size(), features, options);
}

}  // namespace fabloop
