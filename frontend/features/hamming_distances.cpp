// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/hamming_distances.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>

#include "frontend/features/row_minima.h"

namespace fabloop {
namespace {

constexpr std::size_t kWordBytes = sizeof(std::uint64_t);

#if defined(__GNUC__)
#define FABLOOP_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define FABLOOP_ALWAYS_INLINE inline
#endif

std::size_t num_words_of(std::size_t num_bytes) { return (num_bytes + kWordBytes - 1) / kWordBytes; }

void copy_words(const cv::Mat& descriptors, std::size_t num_words, std::uint64_t* words) {
  for (int r = 0; r < descriptors.rows; ++r) {
    std::memcpy(words + static_cast<std::size_t>(r) * num_words, descriptors.ptr(r), static_cast<std::size_t>(descriptors.cols));
  }
}

/// One query against `num_rows` rows, a multiple of kRowStep. kWords is the number of words where it is known, else 0.
template <std::size_t kWords>
FABLOOP_ALWAYS_INLINE void count_row(const std::uint64_t* query, const std::uint64_t* rows, std::size_t num_rows,
                                     std::size_t num_words, float* distances) {
  const std::size_t width = kWords > 0 ? kWords : num_words;
  for (std::size_t begin = 0; begin < num_rows; begin += kRowStep) {
    std::array<std::int32_t, kRowStep> counts{};
    for (std::size_t j = 0; j < kRowStep; ++j) {
      const std::uint64_t* row = rows + (begin + j) * width;
      std::int32_t count = 0;
      for (std::size_t w = 0; w < width; ++w) count += std::popcount(query[w] ^ row[w]);
      counts[j] = count;
    }
    for (std::size_t j = 0; j < kRowStep; ++j) distances[begin + j] = static_cast<float>(counts[j]);
  }
}

FABLOOP_ALWAYS_INLINE void count(const std::uint64_t* query, const std::uint64_t* rows, std::size_t num_rows,
                                 std::size_t num_words, float* distances) {
  switch (num_words) {
    case 4:  // ORB
      return count_row<4>(query, rows, num_rows, num_words, distances);
    case 8:  // BRISK, AKAZE
      return count_row<8>(query, rows, num_rows, num_words, distances);
    default:
      return count_row<0>(query, rows, num_rows, num_words, distances);
  }
}

using Count = void (*)(const std::uint64_t*, const std::uint64_t*, std::size_t, std::size_t, float*);

void count_baseline(const std::uint64_t* query, const std::uint64_t* rows, std::size_t num_rows, std::size_t num_words,
                    float* distances) {
  count(query, rows, num_rows, num_words, distances);
}

#if defined(__x86_64__)
__attribute__((target("popcnt,avx2"))) void count_popcnt(const std::uint64_t* query, const std::uint64_t* rows,
                                                         std::size_t num_rows, std::size_t num_words, float* distances) {
  count(query, rows, num_rows, num_words, distances);
}
#endif

Count fastest_count() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx2")) return count_popcnt;
#endif
  return count_baseline;
}

}  // namespace

PackedBits::PackedBits(const cv::Mat& descriptors)
    : size_(static_cast<std::size_t>(descriptors.rows)), num_bytes_(static_cast<std::size_t>(descriptors.cols)) {
  assert(descriptors.empty() || descriptors.type() == CV_8U);
  words_.resize(stride() * num_words_of(num_bytes_));
  copy_words(descriptors, num_words_of(num_bytes_), words_.data());
}

std::size_t PackedBits::stride() const { return (size_ + kRowStep - 1) / kRowStep * kRowStep; }

void PackedBits::distances(const cv::Mat& queries, float* distances) const {
  assert(queries.type() == CV_8U && static_cast<std::size_t>(queries.cols) == num_bytes_);
  static const Count count_bits = fastest_count();
  const std::size_t num_words = num_words_of(num_bytes_);
  std::vector<std::uint64_t> query_words(static_cast<std::size_t>(queries.rows) * num_words);
  copy_words(queries, num_words, query_words.data());
  for (std::size_t q = 0; q < static_cast<std::size_t>(queries.rows); ++q) {
    float* row = distances + q * stride();
    count_bits(query_words.data() + q * num_words, words_.data(), stride(), num_words, row);
    std::fill(row + size_, row + stride(), std::numeric_limits<float>::infinity());
  }
}

int hamming_distance(const std::uint8_t* a, const std::uint8_t* b, std::size_t num_bytes) {
  int count = 0;
  for (std::size_t i = 0; i < num_bytes; i += kWordBytes) {
    std::uint64_t x = 0, y = 0;
    const std::size_t size = std::min(kWordBytes, num_bytes - i);
    std::memcpy(&x, a + i, size);
    std::memcpy(&y, b + i, size);
    count += std::popcount(x ^ y);
  }
  return count;
}

}  // namespace fabloop
