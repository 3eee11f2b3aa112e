// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/segment_adjustment.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/posegraph/sfm/rolling_shutter_scene.h"

namespace fabloop {
namespace {

using test::make_rolling_shutter_scene;
using test::RollingShutterScene;

constexpr double kReadoutS = 0.08;  // 0.2 at a height of 20: 5 px
constexpr TrackTriangulationOptions kGates{.num_threads = 1};

/// What a global shutter's adjustment makes of the scene, from the true poses.
Segment plain_segment(const RollingShutterScene& world) {
  const Scene scene = world.scene.scene();
  Segment segment = empty_segment(scene);
  for (std::size_t i = 0; i < segment.world_from_cameras.size(); ++i) {
    segment.world_from_cameras[i] = world.scene.world_from_cameras[i];
  }
  for (int round = 0; round < 2; ++round) {
    refresh_all_points(scene, segment, kGates);
    adjust_segment(scene, segment);
  }
  return segment;
}

RollingShutterCheck check(const RollingShutterScene& world) {
  const Segment segment = plain_segment(world);
  return check_rolling_shutter(world.scene.scene(), segment, camera_rates(segment.world_from_cameras, world.times_ns), 0.0);
}

TEST(RollingShutterCheck, TellsTheReadoutTimeAndItsDirection) {
  for (const double readout_s : {kReadoutS, -kReadoutS}) {
    const RollingShutterCheck found = check(make_rolling_shutter_scene(readout_s, {.num_points = 500, .noise_px = 0.3}));
    EXPECT_TRUE(found.is_relevant);
    EXPECT_NEAR(found.readout_s, readout_s, 0.1 * kReadoutS);  // gates and loss hold it back; the model goes on from there
    EXPECT_NEAR(found.px_per_s, 500 * RollingShutterScene::kSpeed / 20, 10);  // focal length times speed over height
  }
}

TEST(RollingShutterCheck, IsSilentOfAGlobalShutter) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const RollingShutterCheck found = check(make_rolling_shutter_scene(0.0, {.num_points = 300, .noise_px = 0.3, .seed = seed}));
    EXPECT_TRUE(found.is_known);
    EXPECT_FALSE(found.is_certain) << found.shift_px() << " px, sigma " << found.shift_sigma_px();
  }
}

TEST(RollingShutterCheck, TellsOfAFlightOneWayNoMoreThanTheCalibrationKnows) {
  const auto flight = [](std::size_t num_strips) {
    return check(make_rolling_shutter_scene(
        0.0, {.num_strips = num_strips, .views_per_strip = 12, .num_points = 400, .tilt_deg = 0, .noise_px = 0.3}));
  };
  // Across the rows one way: the same as rows and columns that are not square to each other.
  const double skew_px = RollingShutterCheckOptions{}.affine_sigma * test::synthetic_camera().height;
  const RollingShutterCheck one_way = flight(1);
  EXPECT_TRUE(!one_way.is_known || one_way.shift_sigma_px() > 0.9 * skew_px);
  EXPECT_LT(flight(2).shift_sigma_px(), 0.5 * skew_px);  // the way back tells them apart
}

TEST(RollingShutter, MakesTheMapExactWhenEstimated) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.num_points = 400});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const ReprojectionStatistics plain = reprojection_statistics(scene, segment);
  const double plain_error = test::centre_error(world.scene, segment.world_from_cameras);
  const auto readout_s = model_rolling_shutter(scene, segment, world.times_ns, kGates, {.shutter = Shutter::RollingEstimated});
  ASSERT_TRUE(readout_s);
  EXPECT_NEAR(*readout_s, kReadoutS, 0.01 * kReadoutS);
  EXPECT_GT(plain.mean_px, 0.1);
  // What is left is what the last round leaves of the estimate.
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, 0.05 * plain.mean_px);
  EXPECT_LT(test::centre_error(world.scene, segment.world_from_cameras), 0.05 * plain_error);
}

TEST(RollingShutter, MakesTheMapExactWhenKnown) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.num_points = 400});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const RollingShutterOptions known{.shutter = Shutter::RollingKnown, .readout_s = kReadoutS};
  EXPECT_EQ(model_rolling_shutter(scene, segment, world.times_ns, kGates, known), kReadoutS);
  constexpr double kFloatPx = 0.02;  // keypoints are floats, velocities follow the poses of the round before
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, kFloatPx);
}

TEST(RollingShutter, FollowsCamerasThatTurnSteadily) {
  // Roll, pitch and yaw move the rows' ends by up to 2 px.
  const RollingShutterScene world =
      make_rolling_shutter_scene(kReadoutS, {.num_points = 400, .tilt_deg = 0}, {0.03, -0.02, 0.05});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const double plain_px = reprojection_statistics(scene, segment).mean_px;
  const auto readout_s = model_rolling_shutter(scene, segment, world.times_ns, kGates, {.shutter = Shutter::RollingEstimated});
  ASSERT_TRUE(readout_s);
  EXPECT_NEAR(*readout_s, kReadoutS, 0.02 * kReadoutS);
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, 0.1 * plain_px);
}

TEST(RollingShutter, LeavesAGlobalShutterAloneAndSaysSo) {
  const RollingShutterScene world = make_rolling_shutter_scene(0.0, {.num_points = 300, .noise_px = 0.3, .seed = 7});
  Segment segment = plain_segment(world);
  const RollingShutterOptions options{.shutter = Shutter::RollingEstimated};
  EXPECT_FALSE(model_rolling_shutter(world.scene.scene(), segment, world.times_ns, kGates, options));
  EXPECT_TRUE(segment.readout_motions.empty());
  EXPECT_NE(rolling_shutter_verdict(check(world), std::nullopt, options).find("taken for global"), std::string::npos);
  EXPECT_EQ(rolling_shutter_verdict(check(world), std::nullopt), "");
}

TEST(RollingShutter, NamesTheRemedyAndContradictsAWrongReadout) {
  RollingShutterCheck seen{.is_known = true, .readout_s = 0.03, .sigma_s = 0.002, .px_per_s = 100};
  judge(seen);
  EXPECT_NE(rolling_shutter_verdict(seen, std::nullopt).find("--rolling-shutter estimate"), std::string::npos);
  const auto known = [](double readout_s) { return RollingShutterOptions{Shutter::RollingKnown, readout_s, {}}; };
  EXPECT_EQ(rolling_shutter_verdict(seen, 0.031, known(0.031)), "");
  EXPECT_NE(rolling_shutter_verdict(seen, 0.06, known(0.06)).find("contradict"), std::string::npos);
}

TEST(RollingShutter, RefusesAReadoutThatIsNoTime) {
  const auto refusal = [](double readout_s) {
    return input_error_of([&] { require_readout({Shutter::RollingKnown, readout_s, {}}); });
  };
  EXPECT_NE(refusal(std::numeric_limits<double>::quiet_NaN()).find("readout time"), std::string::npos);
  EXPECT_NE(refusal(30).find("30"), std::string::npos) << "milliseconds";
  EXPECT_NO_THROW(require_readout({Shutter::RollingKnown, -0.03, {}}));
}

}  // namespace
}  // namespace fabloop
