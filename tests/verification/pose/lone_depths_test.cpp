// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/lone_depths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
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

TEST(LoneDepths, OfFewInliersNoneIsAlone) {
  const TwoViews world = make_two_views({.num_points = 10, .planar = true});
  RelativePose relative = true_pose(world);
  for (const std::size_t count : {2, 1, 0}) {
    relative.inliers.resize(count);
    EXPECT_TRUE(lone_depths(world.pairs, relative, kMaxErrorRad).empty()) << count;
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

TEST(BendingAccidents, WhatTheOthersContradictIsTakenOut) {
  constexpr double kOffLineRad = 0.03;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    TwoViews world = make_two_views({.num_points = 60, .noise_px = 0.5, .planar = true, .seed = seed});
    RelativePose bent = true_pose(world);
    RayPair& accident = world.pairs[7];
    accident = at_other_depth(accident, bent.match_from_query, 0.4);
    const Eigen::Vector3d across = (essential_matrix(bent.match_from_query) * accident.query).normalized();
    accident.match = (accident.match + kOffLineRad * across).normalized();
    // As a pose that the accident has bent to itself, a tenth of a degree off for the others.
    bent.match_from_query.rotation = bent.match_from_query.rotation * rotation_from_vector({0.001, -0.001, 0.001});
    const auto found = find_bending_accidents(world.pairs, bent, {.max_error_rad = kMaxErrorRad});
    ASSERT_TRUE(found) << seed;
    EXPECT_EQ(found->inliers, std::vector<std::size_t>{7}) << seed;
    const double error = found->match_from_query.rotation.angularDistance(world.match_from_query.rotation);
    EXPECT_LT(deg_from_rad(error), 1.5) << seed;
  }
}

}  // namespace
}  // namespace fabloop
