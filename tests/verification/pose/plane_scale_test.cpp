// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/plane_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/verification/two_view_world.h"
#include "verification/verifier.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

/// Of the plane of planar worlds, z = 11 + 0.15 x - 0.1 y in the match's frame.
double height_of(const Eigen::Vector3d& x_in_match) {
  return (11 + 0.15 * x_in_match.x() - 0.1 * x_in_match.y() - x_in_match.z()) / std::sqrt(1 + 0.15 * 0.15 + 0.1 * 0.1);
}

std::vector<Match> all_matches(const TwoViews& world) {
  std::vector<Match> matches;
  for (int i = 0; i < static_cast<int>(world.pairs.size()); ++i) matches.push_back({i, i, 0});
  return matches;
}

std::optional<Scale> plane_scale(const TwoViews& world) {
  const Pose direction{world.match_from_query.rotation, world.match_from_query.translation.normalized()};
  return estimate_plane_scale(world.query, world.match, all_matches(world), direction);
}

TwoViews with_heights(TwoViews world) {
  world.match.height_above_ground = height_of(Eigen::Vector3d::Zero());
  world.query.height_above_ground = height_of(world.match_from_query.translation);
  return world;
}

TEST(PlaneScale, EitherHeightTellsTheBaseline) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const TwoViews both =
        with_heights(make_two_views({.planar = true, .baseline = 1.0 + 0.05 * static_cast<double>(seed), .seed = seed}));
    TwoViews of_match = both, of_query = both;
    of_match.query.height_above_ground.reset();
    of_query.match.height_above_ground.reset();
    for (const TwoViews& world : {both, of_match, of_query}) {
      const auto scale = plane_scale(world);
      ASSERT_TRUE(scale && scale->agrees) << seed;
      // Keypoints are floats: 3e-5 px over 500 px, under a parallax of a twentieth and more.
      EXPECT_NEAR(scale->baseline / world.match_from_query.translation.norm(), 1.0, 1e-4) << seed;
      EXPECT_GE(scale->relative_sigma, 0.05 / std::sqrt(2.0));
    }
  }
}

TEST(PlaneScale, NoiseErrsWithinItsSigma) {
  int num_within = 0, num_worlds = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const TwoViews world = with_heights(make_two_views({.noise_px = 0.5, .planar = true, .seed = seed}));
    const auto scale = plane_scale(world);
    if (!scale) continue;  // some move along the plane's normal, with little parallax
    ++num_worlds;
    num_within += std::abs(std::log(scale->baseline / world.match_from_query.translation.norm())) < 2 * scale->relative_sigma;
  }
  EXPECT_GT(num_worlds, 150);
  // The heights are exact here, so all that errs is the fit, well within the sigma of both.
  EXPECT_GE(num_within, 0.95 * num_worlds);
}

TEST(PlaneScale, ThereIsNoneWithoutAHeightOrAPlane) {
  EXPECT_FALSE(plane_scale(make_two_views({.planar = true})).has_value());
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_FALSE(plane_scale(with_heights(make_two_views({.seed = seed}))).has_value());
}

TEST(PlaneScale, HeightsThatContradictOneAnotherDoNotAgree) {
  TwoViews world = with_heights(make_two_views({.planar = true}));
  *world.query.height_above_ground *= 2;
  const auto scale = plane_scale(world);
  ASSERT_TRUE(scale.has_value());
  EXPECT_FALSE(scale->agrees);
}

TEST(FitPlane, IsThatOfTheMajority) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> across(-0.5, 0.5), off(1.2, 2.0);
  const Eigen::Vector3d inverse_normal(0.01, -0.02, 0.09);
  std::vector<Eigen::Vector3d> rays;
  std::vector<double> depths;
  for (int i = 0; i < 100; ++i) {
    rays.push_back(Eigen::Vector3d(across(random), across(random), 1).normalized());
    depths.push_back((i % 5 < 2 ? off(random) : 1.0) / inverse_normal.dot(rays.back()));  // two in five lie beyond it
  }
  const auto plane = fit_plane(rays, depths, 0.1);
  ASSERT_TRUE(plane.has_value());
  EXPECT_EQ(plane->num_points, 60U);
  EXPECT_LT((plane->inverse_normal - inverse_normal).norm(), 1e-9);
}

TEST(FitPlane, RaysThatLeaveItOpenHaveNone) {
  const std::vector<Eigen::Vector3d> rays(10, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(fit_plane(rays, std::vector<double>(10, 5.0), 0.1).has_value());
  EXPECT_FALSE(fit_plane({}, {}, 0.1).has_value());
}

TEST(PlaneScale, AVerifiedPairOverAPlaneIsMetric) {
  TwoViews world = with_heights(make_two_views({.outlier_ratio = 0.2, .noise_px = 0.3, .planar = true}));
  PosePrior prior{world.match_from_query, Eigen::Matrix<double, 6, 6>::Identity()};  // tells the plane's two poses apart
  prior.covariance.bottomRightCorner<3, 3>() *= 0.01;
  const Verification metric = Verifier().verify(world.query, world.match, {prior});
  ASSERT_EQ(metric.verdict, Verdict::Accepted);
  EXPECT_TRUE(metric.has_scale);
  EXPECT_NEAR(metric.match_from_query.translation.norm(), 2.0, 0.2);
  *world.query.height_above_ground *= 2;
  EXPECT_EQ(Verifier().verify(world.query, world.match, {prior}).verdict, Verdict::ScaleDisagrees);
  world.query.height_above_ground.reset();
  world.match.height_above_ground.reset();
  EXPECT_FALSE(Verifier().verify(world.query, world.match, {prior}).has_scale);
}

}  // namespace
}  // namespace fabloop
