// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "frontend/error.h"
#include "tests/verification/pose_error.h"

namespace fabloop {
namespace {

using testing_support::relative_error;

struct CloudOptions {
  std::size_t num_pairs = 60;
  double outlier_ratio = 0;
  double scale = 1;
  bool has_noise = false;
  PointNoise noise = {};  ///< Of both sides.
  std::uint64_t seed = 1;
};

struct Clouds {
  Pose match_from_query;
  std::vector<PointPair> pairs;
};

/// Points 5 to 15 m in front of the match's camera; the query's stands a little aside.
Clouds make_clouds(const CloudOptions& options) {
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto normal3 = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  const auto measured = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    if (!options.has_noise) return x;
    const double distance = x.norm();
    const Eigen::Vector3d ray = x / distance;
    const Eigen::Vector3d noise = normal3();
    const Eigen::Vector3d along = ray * ray.dot(noise);
    return x + (options.noise.floor + options.noise.across * distance) * (noise - along) +
           (options.noise.floor + options.noise.along * distance + options.noise.along_squared * distance * distance) * along;
  };
  const auto random_point = [&] { return Eigen::Vector3d(uniform(-6, 6), uniform(-5, 5), uniform(5, 15)); };
  Clouds clouds;
  clouds.match_from_query = {rotation_from_vector(0.4 * normal3().normalized()), 2 * normal3().normalized()};
  for (std::size_t i = 0; i < options.num_pairs; ++i) {
    const Eigen::Vector3d x_in_match = random_point();
    const bool is_outlier = static_cast<double>(i) < options.outlier_ratio * static_cast<double>(options.num_pairs);
    const Eigen::Vector3d seen_by_query = is_outlier ? random_point() : x_in_match;
    const Eigen::Vector3d unscaled =
        clouds.match_from_query.rotation.conjugate() * (seen_by_query - clouds.match_from_query.translation);
    clouds.pairs.push_back({measured(unscaled / options.scale), measured(x_in_match)});
  }
  std::shuffle(clouds.pairs.begin(), clouds.pairs.end(), random);
  return clouds;
}

/// Depths from parallax, better than the default so that the noise of a weight is small beside it.
constexpr PointNoise kParallaxNoise{.floor = 0, .across = 0.002, .along = 0.02, .along_squared = 0};
constexpr double kExactAlignment = 1e-6;  // rounding of metres, by a minimiser that stops at a relative decrease of 1e-9

TEST(Alignment, IsExactOnNoiselessData) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const double scale = seed % 2 == 0 ? 1.0 : 0.3 + 0.01 * static_cast<double>(seed);
    const Clouds clouds = make_clouds({.num_pairs = 20, .scale = scale, .seed = seed});
    const auto found =
        align_points(clouds.pairs, {.scale = seed % 2 == 0 ? AlignmentScale::Fixed : AlignmentScale::Free, .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT(relative_error(clouds.match_from_query, found->match_from_query).norm(), kExactAlignment) << "seed " << seed;
    EXPECT_NEAR(found->scale, scale, kExactAlignment) << "seed " << seed;
    EXPECT_EQ(found->inliers.size(), clouds.pairs.size()) << "seed " << seed;
  }
}

TEST(Alignment, ResistsFiftyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Clouds clouds =
        make_clouds({.outlier_ratio = 0.5, .scale = 1.5, .has_noise = true, .noise = kParallaxNoise, .seed = seed});
    const auto found = align_points(clouds.pairs, {.scale = AlignmentScale::Free,
                                                   .query_noise = kParallaxNoise,
                                                   .match_noise = kParallaxNoise,
                                                   .max_iterations = 2000,
                                                   .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    const auto error = relative_error(clouds.match_from_query, found->match_from_query);
    EXPECT_LT(error.head<3>().norm(), 0.3) << "seed " << seed;
    EXPECT_LT(error.tail<3>().norm(), rad_from_deg(2)) << "seed " << seed;
    EXPECT_NEAR(found->scale, 1.5, 0.05) << "seed " << seed;
  }
}

TEST(Alignment, SwappingTheSidesInvertsIt) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Clouds clouds = make_clouds({.scale = 1.2, .has_noise = true, .noise = kParallaxNoise, .seed = seed});
    std::vector<PointPair> swapped;
    for (const PointPair& pair : clouds.pairs) swapped.push_back({pair.in_match, pair.in_query});
    // No pair is left out, so that both directions minimise the same sum.
    const AlignmentOptions options{
        .scale = AlignmentScale::Free, .query_noise = kParallaxNoise, .match_noise = kParallaxNoise, .max_error_sigmas = 10};
    const auto forth = align_points(clouds.pairs, options);
    const auto back = align_points(swapped, options);
    ASSERT_TRUE(forth && back);
    constexpr double kSettled = 1e-6;  // the minimiser stops at a relative decrease of 1e-9, of standard deviations of 1 %
    EXPECT_NEAR(forth->scale * back->scale, 1, kSettled) << "seed " << seed;
    EXPECT_LT(forth->match_from_query.rotation.angularDistance(back->match_from_query.rotation.conjugate()), kSettled);
  }
}

/// Mean over 1000 problems of e^T I e, for the error e over the dimensions that are free.
template <int kDimension>
double mean_alignment_nees(const PointNoise& noise, const AlignmentOptions& options) {
  constexpr int kTrials = 1000;
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const Clouds clouds = make_clouds({.num_pairs = 40, .has_noise = true, .noise = noise, .seed = seed});
    const auto found = align_points(clouds.pairs, options);
    if (!found) return std::nan("");
    Eigen::Matrix<double, 7, 1> error;
    error << relative_error(clouds.match_from_query, found->match_from_query), std::log(found->scale);
    const Eigen::Matrix<double, kDimension, 1> free = error.head<kDimension>();
    sum += free.dot(found->information.topLeftCorner<kDimension, kDimension>() * free);
  }
  return sum / kTrials;
}

/// The sum of 1000 chi-squares of k degrees has the standard deviation sqrt(2 k 1000); 3.3 of them leave one in 1000.
double nees_margin(int degrees) { return 3.3 * std::sqrt(2.0 * degrees / 1000.0); }

TEST(Alignment, ErrorsAreWithinChiSquareBounds) {
  constexpr PointNoise kEqual{.floor = 0.02, .across = 0, .along = 0, .along_squared = 0};
  // 114 or 113 degrees of freedom for the noise's variance.
  const AlignmentOptions fixed{.query_noise = kEqual, .match_noise = kEqual, .max_error_sigmas = 3};
  EXPECT_NEAR(mean_alignment_nees<6>(kEqual, fixed), 6 * 114.0 / 112.0, nees_margin(6));
  AlignmentOptions free = fixed;
  free.scale = AlignmentScale::Free;
  EXPECT_NEAR(mean_alignment_nees<7>(kEqual, free), 7 * 113.0 / 111.0, nees_margin(7));
}

TEST(Alignment, ErrorsAreWithinChiSquareBoundsWhereDepthIsTheWorst) {
  const AlignmentOptions options{.query_noise = kParallaxNoise, .match_noise = kParallaxNoise, .max_error_sigmas = 5};
  EXPECT_NEAR(mean_alignment_nees<6>(kParallaxNoise, options), 6 * 114.0 / 112.0, nees_margin(6));
}

TEST(Alignment, KnowingTheNoisesShapeMakesItBetter) {
  double squared_shaped = 0, squared_round = 0;
  constexpr PointNoise kRound{.floor = 0.2, .across = 0, .along = 0, .along_squared = 0};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Clouds clouds = make_clouds({.has_noise = true, .noise = kParallaxNoise, .seed = seed});
    const auto shaped = align_points(clouds.pairs, {.query_noise = kParallaxNoise, .match_noise = kParallaxNoise});
    const auto round = align_points(clouds.pairs, {.query_noise = kRound, .match_noise = kRound});
    ASSERT_TRUE(shaped && round);
    squared_shaped += relative_error(clouds.match_from_query, shaped->match_from_query).squaredNorm();
    squared_round += relative_error(clouds.match_from_query, round->match_from_query).squaredNorm();
  }
  EXPECT_LT(squared_shaped, 0.5 * squared_round);
}

TEST(Alignment, SaysNothingOfAFixedScale) {
  const Clouds clouds = make_clouds({});
  const auto found = align_points(clouds.pairs);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->scale, 1);
  EXPECT_EQ(found->information.col(6).norm(), 0);
  EXPECT_EQ(found->information.row(6).norm(), 0);
}

TEST(Alignment, RefusesImpossibleInput) {
  Clouds clouds = make_clouds({.num_pairs = 4});
  EXPECT_FALSE(align_points(clouds.pairs).has_value());
  EXPECT_FALSE(align_points({}).has_value());
  EXPECT_THROW(align_points(clouds.pairs, {.query_noise = {.floor = 0, .across = 0}}), InputError);
  EXPECT_THROW(align_points(clouds.pairs, {.match_noise = {.floor = -1}}), InputError);
  EXPECT_THROW(align_points(clouds.pairs, {.max_error_sigmas = 0}), InputError);
  clouds.pairs[2].in_match.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(align_points(clouds.pairs), InputError);
}

}  // namespace
}  // namespace fabloop
