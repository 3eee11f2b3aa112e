// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/lone_depths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "tests/verification/two_view_world.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

constexpr double kMaxErrorRad = 0.004;

/// The world's own pose, with all pairs for inliers.
RelativePose true_pose(const TwoViews& world) {
  RelativePose relative;
  relative.match_from_query = {world.match_from_query.rotation, world.match_from_query.translation.normalized()};
  for (std::size_t i = 0; i < world.pairs.size(); ++i) relative.inliers.push_back(i);
  return relative;
}

double depth_of(const RayPair& pair, const Pose& match_from_query) {
  const RayDepths found = ray_depths(match_from_query.rotation * pair.query, pair.match, match_from_query.translation);
  return found.match / found.squared_sine;
}

/// The same match ray, paired with what the query sees at `times` its depth: on the epipolar line still.
RayPair at_other_depth(const RayPair& pair, const Pose& match_from_query, double times) {
  const Eigen::Vector3d x = times * depth_of(pair, match_from_query) * pair.match;
  return {(match_from_query.inverse() * x).normalized(), pair.match};
}

/// The ray nearest to that of a pair, of those not yet taken.
std::size_t nearest_to(const TwoViews& world, std::size_t i, const std::vector<std::size_t>& taken) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < world.pairs.size(); ++k) {
    if (std::find(taken.begin(), taken.end(), k) != taken.end()) continue;
    if (!best || world.pairs[k].match.dot(world.pairs[i].match) > world.pairs[*best].match.dot(world.pairs[i].match)) best = k;
  }
  return *best;
}

TEST(LoneDepths, AccidentsAlongTheirEpipolarLinesAreFound) {
  std::size_t num_missed = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    TwoViews world = make_two_views({.num_points = 60, .noise_px = 0.5, .planar = true, .seed = seed});
    const RelativePose relative = true_pose(world);
    EXPECT_TRUE(lone_depths(world.pairs, relative, kMaxErrorRad).empty()) << seed;
    const std::vector<std::size_t> accidents{7, 20, 41};
    const double times[] = {0.4, 2.0, 3.0};
    for (std::size_t k = 0; k < accidents.size(); ++k) {
      RayPair& pair = world.pairs[accidents[k]];
      pair = at_other_depth(pair, relative.match_from_query, times[k]);
    }
    const std::vector<std::size_t> lone = lone_depths(world.pairs, relative, kMaxErrorRad);
    EXPECT_TRUE(std::includes(accidents.begin(), accidents.end(), lone.begin(), lone.end())) << seed;
    num_missed += accidents.size() - lone.size();
  }
  EXPECT_LE(num_missed, 5);  // of 300: where the parallax is too small to tell
}

TEST(LoneDepths, ATowerAmongItsLikeIsNotAlone) {
  TwoViews world = make_two_views({.num_points = 200, .noise_px = 0.5, .planar = true});
  const RelativePose relative = true_pose(world);
  std::vector<std::size_t> tower{50};
  while (tower.size() < 8) tower.push_back(nearest_to(world, tower.front(), tower));
  for (const std::size_t i : tower) world.pairs[i] = at_other_depth(world.pairs[i], relative.match_from_query, 0.5);
  EXPECT_TRUE(lone_depths(world.pairs, relative, kMaxErrorRad).empty());
}

TEST(LoneDepths, DepthsThatScatterHaveHardlyAnyAlone) {
  std::size_t num_alone = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const TwoViews world = make_two_views({.num_points = 100, .noise_px = 0.5, .seed = seed});  // 8 to 14 m at random
    num_alone += lone_depths(world.pairs, true_pose(world), kMaxErrorRad).size();
  }
  EXPECT_LE(num_alone, 5);  // of 10,000
}

TEST(LoneDepths, WithoutParallaxDepthSaysNothing) {
  const TwoViews world = make_two_views({.num_points = 100, .noise_px = 0.5, .planar = true, .baseline = 0.02});
  EXPECT_TRUE(lone_depths(world.pairs, true_pose(world), kMaxErrorRad).empty());
}

TEST(LoneDepths, NoInliersAreNoneAlone) {
  const TwoViews world = make_two_views({.num_points = 10, .planar = true});
  RelativePose relative = true_pose(world);
  relative.inliers.clear();
  EXPECT_TRUE(lone_depths(world.pairs, relative, kMaxErrorRad).empty());
}

/// Points in the match's frame as pairs.
std::vector<RayPair> pairs_of(const std::vector<Eigen::Vector3d>& points, const Pose& match_from_query) {
  std::vector<RayPair> pairs;
  for (const Eigen::Vector3d& x : points) pairs.push_back({(match_from_query.inverse() * x).normalized(), x.normalized()});
  return pairs;
}

RelativePose with_all(const std::vector<RayPair>& pairs, const Pose& match_from_query) {
  RelativePose relative;
  relative.match_from_query = match_from_query;
  for (std::size_t i = 0; i < pairs.size(); ++i) relative.inliers.push_back(i);
  return relative;
}

TEST(LoneDepths, ATableInADeepRoomIsNotAlone) {
  const Pose match_from_query{Eigen::Quaterniond::Identity(), Eigen::Vector3d::UnitX()};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back((4.5 + 3.5 * uniform(random)) * Eigen::Vector3d(uniform(random), uniform(random), 1));
  }
  for (int i = 0; i < 50; ++i) points.push_back({0.5 + 0.2 * uniform(random), 0.2 * uniform(random), 1.2});
  const std::vector<RayPair> pairs = pairs_of(points, match_from_query);
  for (const std::size_t i : lone_depths(pairs, with_all(pairs, match_from_query), kMaxErrorRad)) EXPECT_LT(i, 100U);
}

TEST(LoneDepths, UnderAnyParallaxGroundIsNotAloneButAnAccidentIs) {
  for (double parallax_deg = 10; parallax_deg <= 110; parallax_deg += 10) {
    // Two cameras and the middle of the ground make an isosceles triangle; both look at it.
    const double half = 0.5 * rad_from_deg(parallax_deg);
    const double distance = 0.5 / std::sin(half);
    const Pose match_from_query{rotation_from_vector({0, -2 * half, 0}), {std::cos(half), 0, std::sin(half)}};
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-0.3, 0.3);
    const Eigen::Vector3d right(std::cos(half), 0, std::sin(half));
    const Eigen::Vector3d up(-std::sin(half), 0, std::cos(half));
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d along = uniform(random) * right + uniform(random) * Eigen::Vector3d::UnitY();
      points.push_back(distance * (Eigen::Vector3d::UnitZ() + along + 0.1 * uniform(random) * up));
    }
    std::vector<RayPair> pairs = pairs_of(points, match_from_query);
    const RelativePose relative = with_all(pairs, match_from_query);
    EXPECT_TRUE(lone_depths(pairs, relative, kMaxErrorRad).empty()) << parallax_deg;
    pairs[30] = at_other_depth(pairs[30], match_from_query, 0.4);
    EXPECT_EQ(lone_depths(pairs, relative, kMaxErrorRad), std::vector<std::size_t>{30}) << parallax_deg;
  }
}

TEST(BendingAccidents, AMastThatAgreesIsNone) {
  int num_masts = 0, num_refuted = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    TwoViews world = make_two_views({.num_points = 60, .noise_px = 0.5, .seed = seed});
    const RelativePose relative = true_pose(world);
    world.pairs[7] = at_other_depth(world.pairs[7], relative.match_from_query, 0.3);
    num_masts += lone_depths(world.pairs, relative, kMaxErrorRad) == std::vector<std::size_t>{7};
    num_refuted += find_bending_accidents(world.pairs, relative, {.max_error_rad = kMaxErrorRad}).has_value();
  }
  EXPECT_GT(num_masts, 40);
  EXPECT_LE(num_refuted, 3);  // where the others' noise moves what is so near by more than the threshold
}

/// The pairs of a corner of a world, and accidents all over the image behind them.
std::vector<RayPair> corner_and_accidents(std::uint64_t seed, std::size_t num_true, int num_accidents, Pose& truth) {
  const TwoViews world = make_two_views({.num_points = 300, .noise_px = 0.3, .seed = seed});
  truth = world.match_from_query;
  std::vector<RayPair> pairs = world.pairs;
  std::ranges::sort(pairs, {}, [](const RayPair& pair) { return pair.match.x() + pair.match.y(); });
  pairs.resize(num_true);
  const TwoViews random = make_two_views({.num_points = num_accidents, .outlier_ratio = 1, .seed = seed + 1000});
  pairs.insert(pairs.end(), random.pairs.begin(), random.pairs.end());
  return pairs;
}

TEST(BendingAccidents, APoseThatTheyBentIsStraightened) {
  constexpr std::size_t kTrue = 40;
  int num_found = 0;
  double before_deg = 0, after_deg = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Pose truth;
    const std::vector<RayPair> pairs = corner_and_accidents(seed, kTrue, 60, truth);
    const RelativePoseOptions options{.max_error_rad = kMaxErrorRad, .seed = seed};
    const auto bent = estimate_relative_pose(pairs, options);
    ASSERT_TRUE(bent);
    const auto error_deg = [&](const Pose& pose) { return deg_from_rad(pose.rotation.angularDistance(truth.rotation)); };
    if (bent->inliers.back() < kTrue || error_deg(bent->match_from_query) < 1) continue;
    const auto found = find_bending_accidents(pairs, *bent, options);
    if (!found) continue;
    num_found += found->inliers.front() >= kTrue;
    before_deg += error_deg(bent->match_from_query);
    after_deg += error_deg(found->match_from_query);
  }
  EXPECT_GE(num_found, 5);  // of some thirty that are off by a degree and more
  EXPECT_LT(after_deg, 0.5 * before_deg);
}

}  // namespace
}  // namespace fabloop
