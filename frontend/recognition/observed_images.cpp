// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/observed_images.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

using Clock = std::chrono::steady_clock;

/// Images decoded at a time: enough to keep the threads busy, few enough for large images.
constexpr std::size_t kImagesReadAtOnce = 16;

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

ObservedImage observe_image(const SourceImage& image, const FeatureExtractor& extractor, const Model& model, ImageShape shape) {
  ObservedImage observed{image.frame, image.time_ns, {}};
  const auto start = Clock::now();
  const Features features = extract(extractor, image.gray, shape);
  const auto described = Clock::now();
  observed.observation = observe(model.vocabulary, features.descriptors);
  observed.describe_s = seconds_between(start, described);
  observed.words_s = seconds_between(described, Clock::now());
  return observed;
}

}  // namespace

ObservedImages observe_images(ImageSource& source, const Model& model, const ObserveOptions& options) {
  const FeatureExtractor extractor(model.features);
  ObservedImages result;
  result.name = source.name();
  const std::string stage = "words of " + result.name;
  const auto report = [&](std::size_t done, std::size_t total) {
    if (options.progress) options.progress(stage, done, total);
  };
  while (true) {
    const auto start = Clock::now();
    const std::vector<SourceImage> block = source.next(kImagesReadAtOnce);
    result.read_s += seconds_between(start, Clock::now());
    if (block.empty()) break;
    std::vector<ObservedImage> observed(block.size());
    parallel_for(block.size(), options.num_threads,
                 [&](std::size_t i) { observed[i] = observe_image(block[i], extractor, model, options.shape); });
    std::move(observed.begin(), observed.end(), std::back_inserter(result.images));
    const std::size_t done = result.images.size() + source.damaged_frames().size();
    report(done, std::max(done, source.estimated_size().value_or(done + 1)));
  }
  report(result.images.size(), result.images.size());
  result.damaged_frames = source.damaged_frames();
  if (result.images.empty()) throw InputError(result.name + ": has no image that can be read");
  return result;
}

}  // namespace fabloop
