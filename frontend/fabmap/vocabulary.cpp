// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/vocabulary.h"

#include <algorithm>
#include <bit>
#include <cstdint>
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

/// cv::checkRange without its branch for each number, which costs more than reading a mapped model.
bool all_finite(const cv::Mat& numbers) {
  constexpr std::uint32_t kExponent = 0x7f800000u;
  std::uint32_t any_without_end = 0;
  for (int row = 0; row < numbers.rows; ++row) {
    const auto* values = numbers.ptr<float>(row);
    for (int i = 0; i < numbers.cols; ++i) {
      any_without_end |= static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(values[i]) & kExponent) == kExponent);
    }
  }
  return any_without_end == 0;
}

}  // namespace

cv::Mat float_descriptors(const cv::Mat& descriptors) {
  if (descriptors.empty()) return {};
  if (descriptors.type() == CV_8UC1) return expanded_bits(descriptors);
  if (descriptors.type() != CV_32FC1) throw InputError("descriptors must be 32-bit floats or packed bits");
  if (!all_finite(descriptors)) throw InputError("a descriptor has entries that are not finite numbers");
  return descriptors.isContinuous() ? descriptors : descriptors.clone();
}

cv::Mat float_descriptors_for(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  const cv::Mat points = float_descriptors(descriptors);
  if (!points.empty() && points.cols != vocabulary.words.cols) {
    throw InputError("the descriptors have " + std::to_string(points.cols) + " numbers and the vocabulary's words " +
                     std::to_string(vocabulary.words.cols) + "; use the features that the model was trained with");
  }
  return points;
}

std::vector<WordId> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  const cv::Mat points = float_descriptors_for(vocabulary, descriptors);
  if (points.empty()) return {};
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
  if (!all_finite(vocabulary.words)) {
    throw InputError(where + ": the vocabulary has entries that are not finite numbers; train the model again");
  }
}

}  // namespace fabloop
