// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/geometry/similarity.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace fabloop {
namespace {

/// Sums and products of a few dozen numbers near 1.
constexpr double kRounding = 1e-12;

class RandomSimilarities {
 public:
  explicit RandomSimilarities(std::uint32_t seed) : random_(seed) {}
  double number() { return normal_(random_); }
  Eigen::Vector3d vector() { return {number(), number(), number()}; }
  Similarity similarity() {
    return {std::exp(number()), Eigen::Quaterniond(number(), number(), number(), number()).normalized(), vector()};
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

/// The 4 x 4 matrix that maps homogeneous points.
Eigen::Matrix4d matrix_of(const Similarity& similarity) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = similarity.scale * similarity.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = similarity.translation;
  return matrix;
}

TEST(Similarity, ProductsAndInversesAreThoseOfMatrices) {
  RandomSimilarities random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Similarity a_from_b = random.similarity();
    const Similarity b_from_c = random.similarity();
    const Eigen::Vector3d x = random.vector();
    const Eigen::Matrix4d product = matrix_of(a_from_b) * matrix_of(b_from_c);
    EXPECT_LT((matrix_of(a_from_b * b_from_c) - product).norm(), kRounding * product.norm());
    EXPECT_LT((matrix_of(a_from_b.inverse()) * matrix_of(a_from_b) - Eigen::Matrix4d::Identity()).norm(), 1e2 * kRounding);
    EXPECT_LT((a_from_b * x - (matrix_of(a_from_b) * x.homogeneous()).head<3>()).norm(), kRounding * 1e2);
  }
}

/// exp(M) = sum of M^k / k!, by halving M until the series converges at once, and squaring back.
Eigen::Matrix4d exponential(const Eigen::Matrix4d& m) {
  constexpr int kHalvings = 10;
  constexpr int kTerms = 12;
  const Eigen::Matrix4d small = m / (1 << kHalvings);
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d sum = term;
  for (int k = 1; k <= kTerms; ++k) sum += term = term * small / k;
  for (int k = 0; k < kHalvings; ++k) sum = (sum * sum).eval();
  return sum;
}

TEST(Similarity, ExponentialIsThatOfItsMatrix) {
  RandomSimilarities random(2);
  // Both small and large parts, and none.
  for (const double angle : {0.0, 1e-9, 1e-4, 0.02, 1.0}) {
    for (const double sigma : {0.0, 1e-9, 1e-4, 0.02, 1.0}) {
      Vector7d coordinates;
      coordinates << random.vector(), angle * random.vector(), sigma * random.number();
      Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
      generator.topLeftCorner<3, 3>() = cross_matrix(coordinates.segment<3>(3)) + coordinates(6) * Eigen::Matrix3d::Identity();
      generator.topRightCorner<3, 1>() = coordinates.head<3>();
      // Squaring ten times multiplies rounding by a thousand.
      const Eigen::Matrix4d expected = exponential(generator);
      EXPECT_LT((matrix_of(similarity_from_log(coordinates)) - expected).norm(), 1e2 * kRounding * expected.norm())
          << "angle " << angle << ", sigma " << sigma;
    }
  }
}

TEST(Similarity, LogarithmUndoesTheExponential) {
  RandomSimilarities random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Similarity similarity = random.similarity();
    const Similarity again = similarity_from_log(log_of(similarity));
    EXPECT_LT((matrix_of(again) - matrix_of(similarity)).norm(), 1e2 * kRounding * matrix_of(similarity).norm());
  }
  EXPECT_EQ(log_of(Similarity{}), Vector7d::Zero());
}

}  // namespace
}  // namespace fabloop
