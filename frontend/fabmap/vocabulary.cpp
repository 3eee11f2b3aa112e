// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/vocabulary.h"

#include <algorithm>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/nearest_rows.h"

namespace fabloop {
namespace {

constexpr int kBitsPerByte = 8;

cv::Mat expanded_bits(const cv::Mat& descriptors) {
  cv::Mat result(descriptors.rows, descriptors.cols * kBitsPerByte, CV_32F);
  for (int row = 0; row < descriptors.rows; ++row) {
    const auto* bytes = descriptors.ptr<unsigned char>(row);
    auto* numbers = result.ptr<float>(row);
    for (int i = 0; i < result.cols; ++i) numbers[i] = static_cast<float>((bytes[i / kBitsPerByte] >> (i % kBitsPerByte)) & 1);
  }
  return result;
}

}  // namespace

cv::Mat float_descriptors(const cv::Mat& descriptors) {
  if (descriptors.empty()) return {};
  if (descriptors.type() == CV_8UC1) return expanded_bits(descriptors);
  if (descriptors.type() != CV_32FC1) throw InputError("descriptors must be 32-bit floats or packed bits");
  if (!cv::checkRange(descriptors)) throw InputError("a descriptor has entries that are not finite numbers");
  return descriptors.isContinuous() ? descriptors : descriptors.clone();
}

std::vector<WordId> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  const cv::Mat points = float_descriptors(descriptors);
  if (points.empty()) return {};
  if (points.cols != vocabulary.words.cols) {
    throw InputError("the descriptors have " + std::to_string(points.cols) + " numbers and the vocabulary's words " +
                     std::to_string(vocabulary.words.cols) + "; use the features that the model was trained with");
  }
  return nearest_rows(vocabulary.words, points, 1).row;
}

Observation observation_of(std::vector<WordId> words) {
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return {std::move(words)};
}

Observation observe(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  return observation_of(nearest_words(vocabulary, descriptors));
}

void validate(const Vocabulary& vocabulary, const std::string& where) {
  if (vocabulary.words.empty() || vocabulary.words.type() != CV_32FC1 || !vocabulary.words.isContinuous()) {
    throw InputError(where + ": the vocabulary has no words; train the model again");
  }
  if (!cv::checkRange(vocabulary.words)) {
    throw InputError(where + ": the vocabulary has entries that are not finite numbers; train the model again");
  }
}

}  // namespace fabloop
