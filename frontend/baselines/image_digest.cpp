// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/image_digest.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Images decoded at a time: enough to keep the threads busy, few enough for large images.
constexpr std::size_t kImagesAtATime = 16;

}  // namespace

ImageDigester::ImageDigester(const std::vector<PlaceMethod>& methods, const Model* model, const DigestOptions& options)
    : options_(options) {
  for (const PlaceMethod method : methods) {
    if (method == PlaceMethod::SeqSlam) needs_image_ = true;
    if (!needs_model(method)) continue;
    if (!model) throw InputError("the method " + std::string(to_string(method)) + " needs a model; train one first");
    if (!extractor_) extractor_.emplace(model->features);
    if (method == PlaceMethod::Vlad) {
      if (!centres_) centres_ = vlad_centres(model->vocabulary, options.vlad);
    } else if (!words_) {
      words_.emplace(model->vocabulary);
    }
  }
}

ImageDigest ImageDigester::digest(const cv::Mat& gray) const {
  return digest(extractor_ ? extractor_->extract(gray) : Features{}, gray);
}

ImageDigest ImageDigester::digest(const Features& features, const cv::Mat& gray) const {
  ImageDigest digest;
  if (words_) digest.words = words_->nearest_words(features.descriptors);
  if (centres_) digest.vlad = vlad_of(*centres_, features.descriptors);
  if (needs_image_) digest.small = small_image(gray, options_.sequence);
  return digest;
}

ImageDigests digest_images(ImageSource& source, const ImageDigester& digester, const DigestOptions& options) {
  ImageDigests result;
  result.name = source.name();
  const std::string stage = "images of " + result.name;
  while (true) {
    const std::vector<SourceImage> block = source.next(kImagesAtATime);
    if (block.empty()) break;
    std::vector<ImageDigest> digests(block.size());
    parallel_for(block.size(), options.num_threads, [&](std::size_t i) {
      digests[i] = digester.digest(block[i].gray);
      digests[i].frame = block[i].frame;
      digests[i].time_ns = block[i].time_ns;
    });
    std::move(digests.begin(), digests.end(), std::back_inserter(result.images));
    const std::size_t done = result.images.size() + source.damaged_frames().size();
    if (options.progress) options.progress(stage, done, std::max(done, source.estimated_size().value_or(done + 1)));
  }
  result.damaged_frames = source.damaged_frames();
  if (result.images.empty()) throw InputError(result.name + ": has no image that can be read");
  return result;
}

}  // namespace fabloop
