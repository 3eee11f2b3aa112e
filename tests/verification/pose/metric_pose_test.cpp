// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/metric_pose.h"

#include <gtest/gtest.h>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

std::vector<Match> true_matches(const TwoViews& world) {
  std::vector<Match> matches;
  for (int i = 0; i < static_cast<int>(world.pairs.size()); ++i) matches.push_back({i, i, 0.5F});
  return matches;
}

/// Keypoints are floats: 3e-5 px over 500 px, at 14 m.
constexpr double kExactMetricM = 1e-4;

TEST(MetricPoses, FromThePointsOfEitherViewAreTheSamePose) {
  TwoViews world = make_two_views({.with_points = true});
  const Pose query_from_match = world.match_from_query.inverse();
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    world.query.points_in_camera[i] = query_from_match * *world.match.points_in_camera[i];
  }
  const MetricPoses poses = estimate_metric_poses(world.query, world.match, true_matches(world));
  ASSERT_TRUE(poses.from_match_points && poses.from_query_points);
  for (const auto* pose : {&*poses.from_match_points, &*poses.from_query_points}) {
    EXPECT_LT((pose->match_from_query.translation - world.match_from_query.translation).norm(), kExactMetricM);
    EXPECT_EQ(pose->num_inliers, static_cast<int>(world.pairs.size()));
    EXPECT_EQ(pose->inlier_ratio, 1.0);
    EXPECT_GT(pose->median_depth, 8);
    EXPECT_LT(pose->median_depth, 20);
  }
}

TEST(MetricPoses, TheBestHasTheMostInliers) {
  MetricPoses poses;
  EXPECT_EQ(poses.best(), nullptr);
  poses.from_query_points = MetricPose{{}, 20, 1, 10};
  EXPECT_EQ(poses.best(), &*poses.from_query_points);
  poses.from_match_points = MetricPose{{}, 30, 1, 10};
  EXPECT_EQ(poses.best(), &*poses.from_match_points);
}

TEST(MetricPoses, FewPointsGiveNone) {
  TwoViews world = make_two_views({.with_points = true});
  for (std::size_t i = 11; i < world.pairs.size(); ++i) world.match.points_in_camera[i].reset();
  EXPECT_EQ(estimate_metric_poses(world.query, world.match, true_matches(world)).best(), nullptr);
}

}  // namespace
}  // namespace fabloop
