// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/descriptor_distances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace fabloop {
namespace {

cv::Mat1f random_descriptors(int count, int dimension, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  cv::Mat1f descriptors(count, dimension);
  for (float& value : descriptors) value = normal(random);
  return descriptors;
}

TEST(PackedDescriptors, GivesTheDistancesOfTheDefinition) {
  // Sizes around the kernel's panels of 16 columns and tiles of 6 rows, and beyond a block of 60.
  for (const auto& [num_queries, num_descriptors, dimension] :
       {std::array{1, 1, 1}, {5, 15, 7}, {6, 16, 128}, {61, 33, 64}, {128, 100, 61}}) {
    const cv::Mat1f queries = random_descriptors(num_queries, dimension, 1);
    const cv::Mat1f descriptors = random_descriptors(num_descriptors, dimension, 2);
    const cv::Mat1f distances = PackedDescriptors(descriptors).squared_distances(queries);
    ASSERT_EQ(distances.rows, num_queries);
    ASSERT_EQ(distances.cols, num_descriptors);
    for (int q = 0; q < num_queries; ++q) {
      for (int m = 0; m < num_descriptors; ++m) {
        const double exact = cv::norm(queries.row(q), descriptors.row(m), cv::NORM_L2SQR);
        // |a|^2 + |b|^2 - 2 a.b in single precision: a few roundings of the norms' size.
        const double tolerance = 1e-5 * (cv::norm(queries.row(q), cv::NORM_L2SQR) + cv::norm(descriptors.row(m), cv::NORM_L2SQR));
        EXPECT_NEAR(distances(q, m), exact, tolerance) << q << ", " << m;
      }
    }
  }
}

TEST(PackedDescriptors, ADistanceDoesNotDependOnItsCompany) {
  const cv::Mat1f queries = random_descriptors(70, 128, 3);
  const cv::Mat1f descriptors = random_descriptors(40, 128, 4);
  const PackedDescriptors packed(descriptors);
  const cv::Mat1f all = packed.squared_distances(queries);
  for (int begin = 0; begin < queries.rows; begin += 12) {
    const int end = std::min(begin + 12, queries.rows);
    const cv::Mat1f some = packed.squared_distances(queries.rowRange(begin, end));
    for (int q = begin; q < end; ++q) {
      for (int m = 0; m < descriptors.rows; ++m) EXPECT_EQ(some(q - begin, m), all(q, m));
    }
  }
}

TEST(PackedDescriptors, OfNothingAreNoDistances) {
  const PackedDescriptors none(cv::Mat1f(0, 128));
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(none.squared_distances(random_descriptors(3, 128, 5)).cols, 0);
}

}  // namespace
}  // namespace fabloop
