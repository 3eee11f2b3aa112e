// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/row_minima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace fabloop {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<float> random_row(std::mt19937& random, std::size_t size) {
  std::uniform_int_distribution<int> number(0, 60);
  std::vector<float> row(size);
  for (float& value : row) value = static_cast<float>(number(random));
  return row;
}

TEST(RowMinima, AreThoseOfTheDefinition) {
  std::mt19937 random(3);
  for (const std::size_t size : {16u, 32u, 48u, 160u}) {
    for (int trial = 0; trial < 50; ++trial) {
      const std::vector<float> row = random_row(random, size), others = random_row(random, size);
      const float least = *std::min_element(row.begin(), row.end());
      std::vector<float> minima = others;
      EXPECT_EQ(least_of(row.data(), size), least);
      EXPECT_EQ(least_of_and_lower(row.data(), size, minima.data()), least);
      for (std::size_t i = 0; i < size; ++i) EXPECT_EQ(minima[i], std::min(row[i], others[i]));
      const auto first = static_cast<std::size_t>(std::find(row.begin(), row.end(), least) - row.begin());
      EXPECT_EQ(first_equal(row.data(), size, least), first);
      EXPECT_EQ(first_equal(row.data(), size, -1.0F), size);
    }
  }
}

TEST(RowMinima, OfNothingAreInfinity) {
  EXPECT_EQ(least_of(nullptr, 0), kInfinity);
  EXPECT_EQ(first_equal(nullptr, 0, 1.0F), 0u);
}

TEST(RowMinima, ProductsBecomeSquaredDistances) {
  std::vector<float> values(16, 2.0F);
  std::vector<float> norms(16, 5.0F);
  norms[3] = 0.5F;
  norms[15] = kInfinity;
  squared_distances_from_products(values.data(), values.size(), 1.0F, norms.data());
  EXPECT_EQ(values[0], 2.0F);
  EXPECT_EQ(values[3], 0.0F) << "rounding must not make a distance negative";
  EXPECT_EQ(values[15], kInfinity);
}

}  // namespace
}  // namespace fabloop
