// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frontend/baselines/place_method.h"
#include "frontend/baselines/sequence_matching.h"
#include "frontend/baselines/vlad.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/progress.h"
#include "frontend/sequence/image_source.h"

namespace fabloop {

/// What is kept of an image: as much as the methods that were asked for look at.
struct ImageDigest {
  std::size_t frame = 0;  ///< Its position in the source.
  std::int64_t time_ns = 0;
  std::vector<WordId> words;  ///< One a feature, in their order: for FAB-MAP and bags of words.
  cv::Mat vlad;               ///< See vlad_of().
  cv::Mat1f small;            ///< See small_image().
};

struct DigestOptions {
  VladOptions vlad;
  SequenceMatchingOptions sequence;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  Progress progress;
};

/// Looks at images for several methods at once. Safe in parallel. Keeps the model's words, not the model.
class ImageDigester {
 public:
  /// Throws InputError when a method needs a model and `model` is none.
  ImageDigester(const std::vector<PlaceMethod>& methods, const Model* model, const DigestOptions& options = {});

  /// Whether any of the methods looks at features, and at the image itself.
  bool needs_features() const { return words_.has_value() || centres_.has_value(); }
  bool needs_image() const { return needs_image_; }

  /// `gray` is CV_8UC1. Frame and time are left to the caller.
  ImageDigest digest(const cv::Mat& gray) const;

  /// The same of an image whose features (of the model's kind) are known. The image may be empty unless needs_image().
  ImageDigest digest(const Features& features, const cv::Mat& gray) const;

 private:
  DigestOptions options_;
  bool needs_image_ = false;
  std::optional<FeatureExtractor> extractor_;
  std::optional<WordFinder> words_;
  std::optional<Vocabulary> centres_;
};

/// The images of a source, digested.
struct ImageDigests {
  std::string name;
  std::vector<ImageDigest> images;          ///< In order of time; those that could not be read are missing.
  std::vector<std::size_t> damaged_frames;  ///< Those.
};

/// Digests all images that the source still has, in parallel. Throws InputError as ImageSource does, and when there are none.
ImageDigests digest_images(ImageSource& source, const ImageDigester& digester, const DigestOptions& options = {});

}  // namespace fabloop
