// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/hamming_distances.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

namespace fabloop {
namespace {

cv::Mat1b random_bits(int count, int num_bytes, std::uint64_t seed) {
  cv::Mat1b descriptors(count, num_bytes);
  cv::RNG(seed).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  return descriptors;
}

TEST(PackedBits, CountsWhatDiffers) {
  // ORB's, BRISK's and AKAZE's bytes, fewer than a word and more than two; sizes around the step of 16.
  for (const auto& [num_queries, num_descriptors, num_bytes] :
       {std::array{1, 1, 1}, {5, 15, 32}, {6, 16, 64}, {7, 17, 61}, {3, 40, 20}}) {
    const cv::Mat1b queries = random_bits(num_queries, num_bytes, 1), descriptors = random_bits(num_descriptors, num_bytes, 2);
    const PackedBits packed(descriptors);
    std::vector<float> distances(static_cast<std::size_t>(num_queries) * packed.stride());
    packed.distances(queries, distances.data());
    for (std::size_t q = 0; q < static_cast<std::size_t>(num_queries); ++q) {
      const cv::Mat1b query = queries.row(static_cast<int>(q));
      for (std::size_t m = 0; m < packed.stride(); ++m) {
        const float found = distances[q * packed.stride() + m];
        if (m >= packed.size()) {
          EXPECT_EQ(found, std::numeric_limits<float>::infinity());
          continue;
        }
        const cv::Mat1b other = descriptors.row(static_cast<int>(m));
        EXPECT_EQ(found, cv::norm(query, other, cv::NORM_HAMMING)) << q << ", " << m;
        EXPECT_EQ(static_cast<float>(hamming_distance(query[0], other[0], static_cast<std::size_t>(num_bytes))), found);
      }
    }
  }
}

TEST(PackedBits, OfNothingAreNoDistances) {
  const PackedBits none(cv::Mat1b(0, 32));
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(none.stride(), 0u);
}

}  // namespace
}  // namespace fabloop
