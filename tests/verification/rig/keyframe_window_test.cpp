// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/keyframe_window.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "frontend/error.h"
#include "tests/verification/pose_error.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"

namespace fabloop {
namespace {

using testing_support::make_walk;
using testing_support::relative_error;
using testing_support::test_camera;
using testing_support::Walk;

constexpr std::size_t kWindow = 3;

/// Views of a walk that live as long as the test, and windows of them in the frame of their first view.
class WindowedWalk {
 public:
  explicit WindowedWalk(std::uint64_t seed) : walk_(make_walk({.seed = seed})) {
    for (std::size_t i = 0; i < walk_.features.size(); ++i) views_.push_back(make_view(i, test_camera(), walk_.features[i]));
  }

  std::vector<WindowView> window(std::size_t first, std::size_t count = kWindow) const {
    const Pose window_from_world = walk_.world_from_camera[first].inverse();
    std::vector<WindowView> result;
    for (std::size_t i = first; i < first + count; ++i) {
      result.push_back({&views_[i], window_from_world * walk_.world_from_camera[i]});
    }
    return result;
  }

  Pose window_from_window(std::size_t match, std::size_t query) const {
    return walk_.world_from_camera[match].inverse() * walk_.world_from_camera[query];
  }

 private:
  Walk walk_;
  std::vector<View> views_;
};

/// The walk starts again from frame 36 on.
constexpr std::size_t kAgain = 36;

const WindowedWalk& shared_walk() {
  static const WindowedWalk walk(1);
  return walk;
}

TEST(KeyframeWindows, TellTheMetricPoseOfARevisit) {
  const WindowedWalk& walk = shared_walk();
  // 20 m above the ground at 500 px of focal length, 0.3 px are 1 cm; ten of them for the worst of four windows.
  constexpr double kMaxErrorM = 0.1;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto found = verify_windows(walk.window(kAgain + i), walk.window(i));
    ASSERT_TRUE(found.has_value()) << i;
    EXPECT_TRUE(found->has_scale) << i;
    const auto error = relative_error(walk.window_from_window(i, kAgain + i), found->match_from_query);
    EXPECT_LT(error.head<3>().norm(), kMaxErrorM) << i;
    EXPECT_LT(error.tail<3>().norm(), rad_from_deg(0.3)) << i;
    EXPECT_GT(static_cast<int>(found->inliers.size()), found->num_matches * 9 / 10) << i;
    EXPECT_LT(found->log10_false_alarms, -100) << i;
    EXPECT_GE(found->num_view_pairs, 5) << i;  // the same places, and their neighbours
    // The odds against 30 are one in 25,000 for a chi-square of 6 degrees.
    EXPECT_LT(error.dot(found->information * error), 30) << i;
  }
}

TEST(KeyframeWindows, TheOdometrysStepsAreTheUnit) {
  const WindowedWalk& walk = shared_walk();
  std::vector<WindowView> query = walk.window(kAgain), match = walk.window(0);
  const auto once = verify_windows(query, match);
  for (auto* window : {&query, &match}) {
    for (WindowView& view : *window) view.window_from_camera.translation *= 2;
  }
  const auto doubled = verify_windows(query, match);
  ASSERT_TRUE(once && doubled);
  EXPECT_TRUE(doubled->has_scale);
  EXPECT_LT((doubled->match_from_query.translation - 2 * once->match_from_query.translation).norm(), 1e-3);
}

TEST(KeyframeWindows, SwappingThemInvertsThePose) {
  const WindowedWalk& walk = shared_walk();
  const auto forth = verify_windows(walk.window(kAgain), walk.window(0));
  const auto back = verify_windows(walk.window(0), walk.window(kAgain));
  ASSERT_TRUE(forth && back);
  // The matcher prefers one side's ratio, so a few matches differ.
  EXPECT_LT(relative_error(forth->match_from_query, back->match_from_query.inverse()).norm(), 0.02);
}

TEST(KeyframeWindows, TheImagesStraightenABentWindow) {
  const WindowedWalk& walk = shared_walk();
  const std::vector<WindowView> truth = walk.window(0);
  std::vector<WindowView> bent = truth;
  // Two degrees of a step, of which the odometry's length is left alone.
  for (std::size_t i = 1; i < bent.size(); ++i) {
    const Pose step = truth[i - 1].window_from_camera.inverse() * truth[i].window_from_camera;
    const Pose bent_step{step.rotation * rotation_from_vector({0.02, -0.02, 0.02}),
                         rotation_from_vector({0.02, 0.02, -0.02}) * step.translation};
    bent[i].window_from_camera = bent[i - 1].window_from_camera * bent_step;
  }
  constexpr std::size_t kAnchor = 1;
  const RefinedWindow refined = refine_window(bent, kAnchor);
  EXPECT_EQ(refined.num_refined_steps, 2);
  EXPECT_LT(relative_error(bent[kAnchor].window_from_camera, refined.views[kAnchor].window_from_camera).norm(), 1e-12);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose step = truth[i - 1].window_from_camera.inverse() * truth[i].window_from_camera;
    const Pose found = refined.views[i - 1].window_from_camera.inverse() * refined.views[i].window_from_camera;
    EXPECT_LT(found.rotation.angularDistance(step.rotation), rad_from_deg(0.2)) << i;
    EXPECT_LT(angle_between(found.translation, step.translation), rad_from_deg(0.5)) << i;
    EXPECT_NEAR(found.translation.norm(), step.translation.norm(), 1e-9) << i;
  }
  const auto pose_of_bent = verify_windows(walk.window(kAgain), bent);
  const auto pose_of_refined = verify_windows(walk.window(kAgain), refine_window(bent, 0).views);
  ASSERT_TRUE(pose_of_bent && pose_of_refined);
  const Pose pose = walk.window_from_window(0, kAgain);
  EXPECT_LT(relative_error(pose, pose_of_refined->match_from_query).norm(),
            0.3 * relative_error(pose, pose_of_bent->match_from_query).norm());
  EXPECT_GT(pose_of_refined->inliers.size(), pose_of_bent->inliers.size());
}

TEST(KeyframeWindows, OneViewASideTellsNoScale) {
  const WindowedWalk& walk = shared_walk();
  const auto found = verify_windows(walk.window(kAgain, 1), walk.window(0, 1));
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->has_scale);
  const Pose truth = walk.window_from_window(0, kAgain);
  EXPECT_LT(angle_between(found->match_from_query.translation, truth.translation), rad_from_deg(3));
}

TEST(KeyframeWindows, OfDifferentPlacesShareNothing) {
  const WindowedWalk& walk = shared_walk();
  for (const std::size_t i : {8U, 15U, 22U}) {
    const auto found = verify_windows(walk.window(kAgain), walk.window(i));
    EXPECT_FALSE(found.has_value()) << i;
  }
}

TEST(KeyframeWindows, AFeatureThatManyMatchesShareCountsOnce) {
  const WindowedWalk& walk = shared_walk();
  const auto one = verify_windows(walk.window(kAgain, 1), walk.window(0, 1));
  std::vector<WindowView> query = walk.window(kAgain, 1), match = walk.window(0, 1);
  query.push_back(query[0]);  // the same view twice says nothing new
  match.push_back(match[0]);
  const auto four = verify_windows(query, match);
  ASSERT_TRUE(one && four);
  EXPECT_EQ(four->inliers.size(), 4 * one->inliers.size());
  EXPECT_FALSE(four->has_scale);
  // Of the rotation: each feature twice in its window and in two matches there, so twice the information where four times is
  // claimed.
  const double ratio = four->information.bottomRightCorner<3, 3>().trace() / one->information.bottomRightCorner<3, 3>().trace();
  EXPECT_NEAR(ratio, 2, 0.1);
}

TEST(KeyframeWindows, RefuseWhatIsMissing) {
  const WindowedWalk& walk = shared_walk();
  const std::vector<WindowView> window = walk.window(0);
  EXPECT_THROW(verify_windows({}, window), InputError);
  EXPECT_THROW(verify_windows(window, {}), InputError);
  std::vector<WindowView> bad = window;
  bad[1].view = nullptr;
  EXPECT_THROW(verify_windows(bad, window), InputError);
  EXPECT_THROW(refine_window(bad, 0), InputError);
  EXPECT_THROW(refine_window(window, kWindow), InputError);
  bad = window;
  bad[2].window_from_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(verify_windows(window, bad), InputError);
}

}  // namespace
}  // namespace fabloop
