// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/source_training.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Images decoded at a time.
constexpr std::size_t kImagesAtOnce = 16;

/// One line a file: name, size and time; and how the images are taken from them.
std::string identity_of(const std::vector<fs::path>& sources, const SourceTrainingOptions& options) {
  std::vector<fs::path> files;
  for (const fs::path& source : sources) {
    std::error_code none;  // opening it will tell
    if (fs::is_regular_file(source, none)) files.push_back(source);
    for (const auto& entry : fs::recursive_directory_iterator(source, none)) {
      if (entry.is_regular_file(none)) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::ostringstream text;
  text << "every " << options.source.every << ", a second " << options.source.max_images_per_s.value_or(0.0) << ", shape "
       << static_cast<int>(options.shape) << '\n';
  for (const fs::path& file : files) text << file_identity(file);
  return text.str();
}

/// The descriptors of all images, in a state folder or in memory.
class DescribedImages {
 public:
  explicit DescribedImages(WorkState state) : state_(std::move(state)), is_on_disk_(state_.keeps()) {}

  std::size_t size() const { return size_; }

  /// Looks at the source's images, but for those that a former run described.
  void add(ImageSource& source, const FeatureExtractor& extractor, ImageShape shape, const ModelTrainingOptions& options) {
    const std::string stage = "describing " + source.name();
    std::size_t done = 0;
    for (auto block = source.next(kImagesAtOnce); !block.empty(); block = source.next(kImagesAtOnce)) {
      std::vector<cv::Mat> descriptors(block.size());
      parallel_for(block.size(), options.num_threads, [&](std::size_t i) {
        const std::optional<cv::Mat> former = read(size_ + i);
        descriptors[i] = former ? *former : extract(extractor, block[i].gray, shape).descriptors;
      });
      for (const cv::Mat& of_image : descriptors) keep(of_image);
      done += block.size();
      if (options.progress) options.progress(stage, done, std::max(done, source.estimated_size().value_or(done + 1)));
    }
    if (options.progress) options.progress(stage, done, done);
  }

  /// Safe in parallel, but not beside add().
  cv::Mat operator[](std::size_t image) const {
    if (!is_on_disk_) return in_memory_[image];
    if (std::optional<cv::Mat> descriptors = read(image)) return *descriptors;
    throw InputError(state_.folder().string() + ": the descriptors of image " + std::to_string(image) +
                     " are gone; start the training again");
  }

  void discard() { state_.discard(); }

 private:
  static std::string name_of(std::size_t image) { return "image-" + std::to_string(image); }

  std::optional<cv::Mat> read(std::size_t image) const {
    std::optional<StateBytes> bytes = state_.read(name_of(image));
    if (!bytes) return std::nullopt;
    try {
      cv::Mat descriptors;
      bytes->take(descriptors);
      return descriptors;
    } catch (const StateDamaged&) {
      state_.warn_damaged(name_of(image));
      return std::nullopt;
    }
  }

  void keep(const cv::Mat& descriptors) {
    if (!is_on_disk_) in_memory_.push_back(descriptors);
    if (is_on_disk_ && !state_.has(name_of(size_))) {
      const std::string folder = state_.folder().string();
      StateBytes bytes;
      bytes.put(descriptors);
      state_.write(name_of(size_), bytes);
      if (!state_.keeps()) throw InputError(folder + ": there is no room for the images' descriptors; choose another --out");
    }
    ++size_;
  }

  WorkState state_;
  bool is_on_disk_;
  std::vector<cv::Mat> in_memory_;
  std::size_t size_ = 0;
};

WorkState state_for_images(const ModelTrainingOptions& options, const std::string& identity) {
  if (options.state_folder.empty()) return {};
  fs::path folder = options.state_folder;
  folder += ".images";
  return {folder, "training", features_text(options.features) + identity, options.if_state_found, options.warn};
}

}  // namespace

TrainedModel train_model(const std::vector<fs::path>& sources, const SourceTrainingOptions& source_options,
                         const ModelTrainingOptions& options) {
  std::vector<ImageSource> opened;
  for (const fs::path& source : sources) opened.emplace_back(source, source_options.source);
  ModelTrainingOptions identified = options;
  identified.images_identity += identity_of(sources, source_options);
  DescribedImages images(state_for_images(options, identified.images_identity));
  try {
    const FeatureExtractor extractor(options.features);
    for (ImageSource& source : opened) images.add(source, extractor, source_options.shape, options);
    const FeatureSource features = [&](std::size_t image) {
      return Features{options.features.kind.descriptor, {}, images[image]};
    };
    TrainedModel trained = train_model(images.size(), features, identified);
    images.discard();
    return trained;
  } catch (const InputError&) {
    images.discard();  // they are of images or options that must change
    throw;
  }
}

}  // namespace fabloop
