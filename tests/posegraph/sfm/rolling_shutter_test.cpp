// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/georeference.h"
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

/// The first view's distance from the farthest, which holds the unit of length.
double extent(const Segment& segment) {
  double distance = 0;
  for (const auto& pose : segment.world_from_cameras) {
    distance = std::max(distance, (pose->translation - segment.world_from_cameras.front()->translation).norm());
  }
  return distance;
}

constexpr double kUnit = 1e-5;  // the adjustments hold it with a sigma of 1e-6 each

RollingShutterCheck check(const RollingShutterScene& world) {
  const Segment segment = plain_segment(world);
  return check_rolling_shutter(world.scene.scene(), segment, camera_rates(segment.world_from_cameras, world.times_ns), 0.0);
}

TEST(RollingShutterCheck, TellsTheReadoutTimeAndItsDirection) {
  for (const double readout_s : {kReadoutS, -kReadoutS}) {
    const RollingShutterCheck found =
        check(make_rolling_shutter_scene(readout_s, {.views_per_strip = 7, .num_points = 500, .noise_px = 0.3}));
    EXPECT_TRUE(found.is_relevant);
    EXPECT_NEAR(found.readout_s, readout_s, 0.1 * kReadoutS);  // gates and loss hold it back; the model goes on from there
    EXPECT_NEAR(found.px_per_s, 500 * RollingShutterScene::kSpeed / 20, 10);  // focal length times speed over height
  }
}

TEST(RollingShutterCheck, IsSilentOfAGlobalShutter) {
  constexpr int kNumFlights = 20;
  // As few images as can be. Looking straight down they tell some of the calibration's errors badly.
  for (const double tilt_deg : {0.0, 8.0}) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= kNumFlights; ++seed) {
      const RollingShutterCheck found = check(make_rolling_shutter_scene(
          0.0, {.num_strips = 2, .views_per_strip = 9, .num_points = 200, .tilt_deg = tilt_deg, .noise_px = 0.3, .seed = seed}));
      ASSERT_TRUE(found.is_known);
      EXPECT_FALSE(found.is_certain) << found.shift_px() << " px, sigma " << found.shift_sigma_px();
      squares += std::pow(found.readout_s / found.sigma_s, 2);
    }
    EXPECT_LT(std::sqrt(squares / kNumFlights), 1.3);  // sigmas: one, and two deviations of what 20 flights tell of it
  }
}

TEST(RollingShutterCheck, KnowsNothingFromFewImages) {
  for (const std::size_t views_per_strip : {2U, 3U, 5U, 8U}) {
    for (const double readout_s : {0.0, kReadoutS}) {
      const RollingShutterCheck found = check(make_rolling_shutter_scene(
          readout_s, {.num_strips = 2, .views_per_strip = views_per_strip, .num_points = 300, .noise_px = 0.3}));
      EXPECT_FALSE(found.is_known || found.is_certain || found.is_relevant) << 2 * views_per_strip << " images";
    }
  }
}

TEST(RollingShutterCheck, LeavesOutViewsThatSeeNothing) {
  const RollingShutterScene world =
      make_rolling_shutter_scene(kReadoutS, {.views_per_strip = 7, .num_points = 400, .noise_px = 0.3});
  const Scene scene = world.scene.scene();
  const Segment whole = plain_segment(world);
  const auto rates = camera_rates(whole.world_from_cameras, world.times_ns);
  const RollingShutterCheck of_all = check_rolling_shutter(scene, whole, rates, 0.0);
  ASSERT_TRUE(of_all.is_known);
  const std::size_t farthest = whole.world_from_cameras.size() - 1;  // at the other end of the last strip
  for (const std::size_t blind : {std::size_t{0}, std::size_t{3}, farthest}) {
    Segment segment = whole;
    for (std::size_t t = 0; t < segment.points.size(); ++t) {
      if (!segment.points[t]) continue;
      auto& seen_by = segment.points[t]->seen_by;
      std::erase_if(seen_by, [&](std::uint32_t i) { return scene.tracks.tracks[t][i].view == blind; });
      if (seen_by.size() < 2) segment.points[t].reset();
    }
    const RollingShutterCheck of_others = check_rolling_shutter(scene, segment, rates, 0.0);
    EXPECT_TRUE(of_others.is_known) << blind;
    EXPECT_NEAR(of_others.shift_px(), of_all.shift_px(), 4 * of_all.shift_sigma_px()) << blind;
  }
}

TEST(RollingShutterCheck, TellsOfAFlightOneWayNoMoreThanTheCalibrationKnows) {
  const auto flight = [](std::size_t num_strips) {
    return check(make_rolling_shutter_scene(
        0.0, {.num_strips = num_strips, .views_per_strip = 24 / num_strips, .num_points = 400, .tilt_deg = 0, .noise_px = 0.3}));
  };
  // Across the rows one way: the same as rows and columns that are not square to each other.
  const double skew_px = RollingShutterCheckOptions{}.affine_sigma * test::synthetic_camera().height;
  const RollingShutterCheck one_way = flight(1), two_ways = flight(2);
  ASSERT_TRUE(one_way.is_known);
  EXPECT_GT(one_way.shift_sigma_px(), 0.9 * skew_px);
  ASSERT_TRUE(two_ways.is_known);
  EXPECT_LT(two_ways.shift_sigma_px(), 0.5 * skew_px);  // the way back tells them apart
}

TEST(RollingShutter, MakesTheMapExactWhenEstimated) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.views_per_strip = 7, .num_points = 400});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const ReprojectionStatistics plain = reprojection_statistics(scene, segment);
  const double plain_error = test::centre_error(world.scene, segment.world_from_cameras);
  const double plain_extent = extent(segment);
  const auto modelled = model_rolling_shutter(scene, segment, world.times_ns, kGates, {.shutter = Shutter::RollingEstimated});
  ASSERT_TRUE(modelled);
  EXPECT_TRUE(modelled->has_settled);
  EXPECT_NEAR(modelled->readout_s, kReadoutS, 0.01 * kReadoutS);
  EXPECT_GT(plain.mean_px, 0.1);
  // What is left is what the last round leaves of the estimate.
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, 0.05 * plain.mean_px);
  EXPECT_LT(test::centre_error(world.scene, segment.world_from_cameras), 0.05 * plain_error);
  EXPECT_NEAR(extent(segment), plain_extent, kUnit * plain_extent);
}

TEST(RollingShutter, MakesTheMapExactWhenKnown) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.views_per_strip = 7, .num_points = 400});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const RollingShutterOptions known{.shutter = Shutter::RollingKnown, .readout_s = kReadoutS};
  const double plain_extent = extent(segment);
  const auto modelled = model_rolling_shutter(scene, segment, world.times_ns, kGates, known);
  ASSERT_TRUE(modelled);
  EXPECT_EQ(modelled->readout_s, kReadoutS);
  EXPECT_NEAR(extent(segment), plain_extent, kUnit * plain_extent);
  constexpr double kFloatPx = 0.02;  // keypoints are floats, velocities follow the poses of the round before
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, kFloatPx);
}

TEST(RollingShutter, FollowsCamerasThatTurnSteadily) {
  // Roll, pitch and yaw move the rows' ends by up to 2 px.
  const RollingShutterScene world =
      make_rolling_shutter_scene(kReadoutS, {.views_per_strip = 7, .num_points = 400, .tilt_deg = 0}, {0.03, -0.02, 0.05});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const double plain_px = reprojection_statistics(scene, segment).mean_px;
  const auto modelled = model_rolling_shutter(scene, segment, world.times_ns, kGates, {.shutter = Shutter::RollingEstimated});
  ASSERT_TRUE(modelled);
  EXPECT_TRUE(modelled->has_settled);
  EXPECT_NEAR(modelled->readout_s, kReadoutS, 0.02 * kReadoutS);
  EXPECT_LT(reprojection_statistics(scene, segment).mean_px, 0.1 * plain_px);
}

TEST(RollingShutter, LeavesAGlobalShutterAloneAndSaysSo) {
  const RollingShutterScene world =
      make_rolling_shutter_scene(0.0, {.views_per_strip = 7, .num_points = 300, .noise_px = 0.3, .seed = 7});
  Segment segment = plain_segment(world);
  const RollingShutterOptions options{.shutter = Shutter::RollingEstimated};
  EXPECT_FALSE(model_rolling_shutter(world.scene.scene(), segment, world.times_ns, kGates, options));
  EXPECT_TRUE(segment.readout_motions.empty());
  EXPECT_NE(rolling_shutter_verdict(check(world), std::nullopt, options).find("taken for global"), std::string::npos);
  EXPECT_EQ(rolling_shutter_verdict(check(world), std::nullopt), "");
}

TEST(RollingShutter, KeepsTheLastReadoutWhereTheImagesTellNoOther) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.num_points = 300});  // 15 images
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const RollingShutterOptions options{.shutter = Shutter::RollingEstimated};
  EXPECT_FALSE(model_rolling_shutter(scene, segment, world.times_ns, kGates, options));
  const ModelledReadout kept = follow_rolling_shutter(scene, segment, world.times_ns, kReadoutS, kGates, options);
  EXPECT_EQ(kept.readout_s, kReadoutS);
  EXPECT_FALSE(kept.has_settled);
  EXPECT_FALSE(segment.readout_motions.empty());
  EXPECT_NE(rolling_shutter_verdict({}, kept, options).find("not settled: the map is made with 0.08 s"), std::string::npos);
}

TEST(RollingShutter, FollowsACameraThatHasChanged) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.views_per_strip = 7, .num_points = 400});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  const RollingShutterOptions options{.shutter = Shutter::RollingEstimated};
  const ModelledReadout found = follow_rolling_shutter(scene, segment, world.times_ns, 0.5 * kReadoutS, kGates, options);
  EXPECT_TRUE(found.has_settled);
  EXPECT_NEAR(found.readout_s, kReadoutS, 0.01 * kReadoutS);
}

TEST(RollingShutter, MovesWithItsWorld) {
  const RollingShutterScene world = make_rolling_shutter_scene(kReadoutS, {.num_points = 200});
  const Scene scene = world.scene.scene();
  Segment segment = plain_segment(world);
  model_rolling_shutter(scene, segment, world.times_ns, kGates, {.shutter = Shutter::RollingKnown, .readout_s = kReadoutS});
  const ReprojectionStatistics before = reprojection_statistics(scene, segment);
  move_segment(segment, 3.0, {rotation_from_vector({0.3, -1.2, 0.7}), {10, -20, 30}});
  EXPECT_NEAR(reprojection_statistics(scene, segment).mean_px, before.mean_px, 1e-9);
}

RollingShutterCheck seen_shutter(double shift_px, double sigma_px) {
  RollingShutterCheck seen{.is_known = true, .readout_s = 0.01 * shift_px, .sigma_s = 0.01 * sigma_px, .px_per_s = 100};
  judge(seen);
  return seen;
}

TEST(RollingShutter, SaysWhyItIsTakenForGlobal) {
  const auto verdict = [](const RollingShutterCheck& seen) {
    return rolling_shutter_verdict(seen, std::nullopt, {.shutter = Shutter::RollingEstimated});
  };
  EXPECT_NE(verdict(seen_shutter(0.8, 0.05)).find("of too little to bend the map"), std::string::npos);
  EXPECT_NE(verdict(seen_shutter(0.01, 0.01)).find("the images show that it is"), std::string::npos);
  EXPECT_NE(verdict(seen_shutter(0.5, 0.4)).find("open"), std::string::npos);
  EXPECT_NE(verdict({}).find("too few"), std::string::npos);
}

TEST(RollingShutter, NamesTheRemedyAndContradictsAWrongReadout) {
  const RollingShutterCheck seen = seen_shutter(3.0, 0.2);
  EXPECT_NE(rolling_shutter_verdict(seen, std::nullopt).find("--rolling-shutter estimate"), std::string::npos);
  const auto of_known = [&](double readout_s) {
    return rolling_shutter_verdict(seen, ModelledReadout{readout_s}, {.shutter = Shutter::RollingKnown, .readout_s = readout_s});
  };
  EXPECT_EQ(of_known(0.031), "");
  EXPECT_NE(of_known(0.06).find("contradict"), std::string::npos);
}

TEST(RollingShutter, SpeaksOfStepsWhereImagesHaveNoTimes) {
  const std::string text = rolling_shutter_verdict(seen_shutter(3.0, 0.2), std::nullopt, {.has_times = false});
  EXPECT_NE(text.find("0.03 of the step"), std::string::npos) << text;
  const RollingShutterOptions known{.shutter = Shutter::RollingKnown, .readout_s = 0.03, .has_times = false};
  EXPECT_NE(input_error_of([&] { require_readout(known); }).find("no time stamps"), std::string::npos);
  EXPECT_NO_THROW(require_readout({.shutter = Shutter::RollingEstimated, .has_times = false}));
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
