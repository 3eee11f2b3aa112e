// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/pose_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "frontend/geometry/pose.h"
#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViewOptions;
using testing_support::TwoViews;

constexpr double kLensFocalPx = 500;  // of test_camera()
constexpr double kPoseGateRad = 2.0 / kLensFocalPx;

std::vector<Match> each_with_its_own(std::size_t count) {
  std::vector<Match> matches(count);
  for (std::size_t i = 0; i < count; ++i) matches[i] = {static_cast<int>(i), static_cast<int>(i), 0};
  return matches;
}

/// A lens that the calibration does not describe: an error of up to 0.3 px that is alike for rays near one another.
void bend_by_lens(std::vector<RayPair>& pairs) {
  constexpr double kError = 0.3 / kLensFocalPx;
  const auto bent = [&](const Eigen::Vector3d& ray, const Eigen::Vector2d& direction) {
    const double u = ray.x() / ray.z(), v = ray.y() / ray.z();
    const Eigen::Vector2d waves(std::sin(9 * u + 2) * std::cos(7 * v), std::cos(8 * u) * std::sin(9 * v + 1));
    const Eigen::Vector2d error = kError * direction.cwiseProduct(waves);
    return Eigen::Vector3d(u + error.x(), v + error.y(), 1).normalized();
  };
  for (RayPair& pair : pairs) pair = {bent(pair.query, {1, 1}), bent(pair.match, {-1, 0.5})};
}

/// The pose that is chosen for a plane without odometry or depths; none where nothing tells it.
std::optional<Pose> decided_pose(const TwoViews& world, std::uint64_t seed) {
  RelativePoseOptions options;
  options.max_error_rad = kPoseGateRad;
  options.seed = seed;
  auto found = estimate_relative_pose(world.pairs, options);
  if (!found) return std::nullopt;
  const PoseChoice choice = choose_pose(world.query, world.match, each_with_its_own(world.pairs.size()), world.pairs,
                                        std::move(*found), {options, {}, {}}, {});
  if (choice.lead && *choice.lead < kMinLead) return std::nullopt;
  return choice.chosen.relative.match_from_query;
}

TEST(PoseChoice, ManyMatchesDoNotMakeALensErrorDecide) {
  // More than a thousand matches tell apart noises that differ by a twentieth; what differs is how either pose takes up the lens.
  int num_wrong = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    TwoViews world = make_two_views({.num_points = 1500, .noise_px = 0.2, .planar = true, .baseline = 0.3, .seed = seed});
    bend_by_lens(world.pairs);
    const auto pose = decided_pose(world, seed);
    num_wrong += pose && deg_from_rad(angle_between(pose->translation, world.match_from_query.translation)) > 10;
  }
  EXPECT_EQ(num_wrong, 0);
}

TEST(PoseChoice, PosesThatDifferByMuchAreToldApartByTheirRays) {
  int num_right = 0;
  constexpr int kNumWorlds = 20;
  for (std::uint64_t seed = 1; seed <= kNumWorlds; ++seed) {
    const TwoViews world = make_two_views({.num_points = 300, .noise_px = 0.2, .baseline = 2.0, .seed = seed});
    const auto pose = decided_pose(world, seed);
    num_right += pose && deg_from_rad(angle_between(pose->translation, world.match_from_query.translation)) < 5;
  }
  EXPECT_EQ(num_right, kNumWorlds);
}

void append_rays(View& view, const View& more) {
  view.rays.insert(view.rays.end(), more.rays.begin(), more.rays.end());
  view.points_in_camera.resize(view.rays.size());
}

TEST(PoseChoice, PairsThatTheOtherPoseOfAPlaneLosesTellItApart) {
  // Nearly a plane: both poses fit most pairs alike, and a few trees only the right one.
  constexpr int kNumWorlds = 10;
  int num_right = 0;
  for (std::uint64_t seed = 1; seed <= kNumWorlds; ++seed) {
    TwoViews world = make_two_views({.num_points = 170, .noise_px = 0.2, .planar = true, .baseline = 1.0, .seed = seed});
    const TwoViews trees = make_two_views({.num_points = 30, .noise_px = 0.2, .baseline = 1.0, .seed = seed});
    ASSERT_EQ(trees.match_from_query.translation, world.match_from_query.translation);
    world.pairs.insert(world.pairs.end(), trees.pairs.begin(), trees.pairs.end());
    append_rays(world.query, trees.query);
    append_rays(world.match, trees.match);
    const auto pose = decided_pose(world, seed);
    num_right += pose && deg_from_rad(angle_between(pose->translation, world.match_from_query.translation)) < 5;
  }
  EXPECT_EQ(num_right, kNumWorlds);
}

TEST(PoseChoice, APlanesPoseIsRefinedToItsEnd) {
  // Worlds of the benchmark in which the refinement from the best sample stops a degree and more short of where the pairs lie
  // closest; the poses of the plane's homography start on the other side.
  for (const std::uint64_t seed : {283, 298, 422, 549, 867}) {
    const TwoViews world = make_two_views({.outlier_ratio = 0.5, .noise_px = 0.5, .planar = true, .seed = seed + 1});
    RelativePoseOptions options;
    options.max_error_rad = 1.5 / kLensFocalPx;
    options.max_iterations = 100000;
    options.seed = seed;
    auto found = estimate_relative_pose(world.pairs, options);
    ASSERT_TRUE(found);
    PosePrior prior{world.match_from_query, {}};
    prior.covariance.setIdentity();  // metres and radians: enough to tell the plane's two poses apart, and no more
    prior.covariance *= 0.2 * 0.2;
    const Pose chosen = choose_pose(world.query, world.match, each_with_its_own(world.pairs.size()), world.pairs,
                                    std::move(*found), {options, {}, {}}, prior)
                            .chosen.relative.match_from_query;
    EXPECT_LT(deg_from_rad(chosen.rotation.angularDistance(world.match_from_query.rotation)), 1) << seed;
    EXPECT_LT(deg_from_rad(angle_between(chosen.translation, world.match_from_query.translation)), 5) << seed;
  }
}

}  // namespace
}  // namespace fabloop
