// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/training_images.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "frontend/fabmap/sampling.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Images looked at between two reports of progress, and lost by a kill.
constexpr std::size_t kImagesPerBlock = 32;

cv::Mat sampled_rows(const cv::Mat& descriptors, std::size_t wanted, std::uint64_t seed) {
  cv::Mat result;
  for (const std::size_t row : sample_without_replacement(static_cast<std::size_t>(descriptors.rows), wanted, seed)) {
    result.push_back(descriptors.row(static_cast<int>(row)));
  }
  return float_descriptors(result);
}

ImageWords words_of_image(const WordFinder& finder, const cv::Mat& descriptors, std::uint64_t seed) {
  std::vector<WordId> words = finder.nearest_words(descriptors);
  const std::size_t count = words.size();
  std::vector<WordId> two_thirds;
  for (const std::size_t i : sample_without_replacement(count, count - count / 3, seed)) {
    two_thirds.push_back(words[i]);
  }
  return {observation_of(std::move(words)), observation_of(std::move(two_thirds))};
}

StateBytes bytes_of(const std::vector<cv::Mat>& block) {
  StateBytes bytes;
  for (const cv::Mat& descriptors : block) bytes.put(descriptors);
  return bytes;
}

StateBytes bytes_of(const std::vector<ImageWords>& block) {
  StateBytes bytes;
  for (const ImageWords& image : block) {
    bytes.put(image.observation.words);
    bytes.put(image.two_thirds.words);
  }
  return bytes;
}

void take(StateBytes& bytes, cv::Mat& descriptors) { bytes.take(descriptors); }

void take(StateBytes& bytes, ImageWords& image) {
  bytes.take(image.observation.words);
  bytes.take(image.two_thirds.words);
}

/// `count` things from a state file; none where it is missing or damaged.
template <typename T>
std::optional<std::vector<T>> read_all(const WorkState& state, const std::string& name, std::size_t count) {
  return state.read_as(name, [&](StateBytes& bytes) {
    std::vector<T> things(count);
    for (T& thing : things) take(bytes, thing);
    return things;
  });
}

}  // namespace

TrainingImages::TrainingImages(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options,
                               WorkState& state)
    : num_images_(num_images),
      features_(features),
      options_(options),
      state_(state),
      kept_((num_images + kImagesPerBlock - 1) / kImagesPerBlock) {}

std::size_t TrainingImages::first_image(std::size_t block) const { return block * kImagesPerBlock; }

std::size_t TrainingImages::end_image(std::size_t block) const { return std::min(first_image(block + 1), num_images_); }

void TrainingImages::for_each_block(std::string_view stage, const std::function<void(std::size_t block)>& body) const {
  for (std::size_t block = 0; block < kept_.size(); ++block) {
    body(block);
    if (options_.progress) options_.progress(stage, end_image(block), num_images_);
  }
}

TrainingImages::Block TrainingImages::describe(std::size_t block) const {
  Block descriptors(end_image(block) - first_image(block));
  parallel_for(descriptors.size(), options_.num_threads,
               [&](std::size_t i) { descriptors[i] = features_(first_image(block) + i).descriptors; });
  return descriptors;
}

void TrainingImages::keep(std::size_t block, Block descriptors) {
  std::size_t bytes = 0;
  for (const cv::Mat& image : descriptors) bytes += image.total() * image.elemSize();
  if (kept_bytes_ + bytes > (state_.keeps() ? options_.max_state_bytes : options_.max_kept_bytes)) return;
  kept_bytes_ += bytes;
  if (state_.keeps()) {
    state_.write(numbered_name("descriptors", block), bytes_of(descriptors));
  } else {
    kept_[block] = std::move(descriptors);
  }
}

cv::Mat TrainingImages::sample_of(std::size_t block) {
  const std::string name = numbered_name("sample", block);
  if (auto found = read_all<cv::Mat>(state_, name, 1)) return found->front();
  const std::size_t share = (options_.max_descriptors + num_images_ - 1) / num_images_;
  Block descriptors = describe(block);
  cv::Mat sample;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const cv::Mat of_image = sampled_rows(descriptors[i], share, options_.seed + first_image(block) + i);
    if (!of_image.empty()) sample.push_back(of_image);
  }
  keep(block, std::move(descriptors));
  state_.write(name, bytes_of(Block{sample}));
  return sample;
}

cv::Mat TrainingImages::sample_descriptors() {
  cv::Mat sample;
  for_each_block("describing images", [&](std::size_t block) {
    const cv::Mat of_block = sample_of(block);
    if (!of_block.empty()) sample.push_back(of_block);
  });
  return sample;
}

TrainingImages::Block TrainingImages::descriptors_of(std::size_t block) {
  if (!kept_[block].empty()) return std::exchange(kept_[block], {});
  if (auto found = read_all<cv::Mat>(state_, numbered_name("descriptors", block), end_image(block) - first_image(block))) {
    return std::move(*found);
  }
  return describe(block);
}

std::vector<ImageWords> TrainingImages::words_of(std::size_t block, const WordFinder& finder) {
  const std::string name = numbered_name("words", block);
  const std::size_t count = end_image(block) - first_image(block);
  if (auto found = read_all<ImageWords>(state_, name, count)) return std::move(*found);
  const Block descriptors = descriptors_of(block);
  std::vector<ImageWords> images(count);
  parallel_for(count, options_.num_threads, [&](std::size_t i) {
    images[i] = words_of_image(finder, descriptors[i], options_.seed + first_image(block) + i);
  });
  state_.write(name, bytes_of(images));
  state_.remove(numbered_name("descriptors", block));
  return images;
}

std::vector<ImageWords> TrainingImages::find_words(const Vocabulary& vocabulary) {
  const WordFinder finder(vocabulary);
  std::vector<ImageWords> images;
  images.reserve(num_images_);
  for_each_block("finding words", [&](std::size_t block) {
    for (ImageWords& image : words_of(block, finder)) images.push_back(std::move(image));
  });
  return images;
}

}  // namespace fabloop
