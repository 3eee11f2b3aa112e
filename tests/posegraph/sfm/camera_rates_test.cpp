// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/camera_rates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fabloop {
namespace {

struct StampedCameras {
  std::vector<std::optional<Pose>> world_from_cameras;
  std::vector<std::int64_t> times_ns;
  void add(double time_s, const Pose& pose) {
    times_ns.push_back(static_cast<std::int64_t>(std::llround(1e9 * time_s)));
    world_from_cameras.emplace_back(pose);
  }
  std::vector<CameraRate> rates() const { return camera_rates(world_from_cameras, times_ns); }
};

TEST(CameraRates, AreThoseOfAVideo) {
  const Eigen::Vector3d velocity(3, -1, 0.5), turn(0.1, 0.4, -0.2);
  StampedCameras video;
  for (int i = 0; i < 20; ++i) video.add(i / 30.0, {rotation_from_vector(i / 30.0 * turn), i / 30.0 * velocity});
  for (const CameraRate& rate : video.rates()) {
    EXPECT_LT((rate.velocity_in_world_per_s - velocity).norm(), 1e-6);
    EXPECT_LT((rate.turn_per_s - turn).norm(), 1e-6);
  }
}

TEST(CameraRates, TakeTheSpeedFromSeveralStepsWhereStampsAreCoarse) {
  StampedCameras photos;
  constexpr double kSpeed = 5;
  for (int i = 0; i < 20; ++i) photos.add(std::floor(2.4 * i), {Eigen::Quaterniond::Identity(), {2.4 * kSpeed * i, 0, 0}});
  for (std::size_t i = 3; i + 3 < photos.times_ns.size(); ++i) {
    EXPECT_NEAR(photos.rates()[i].velocity_in_world_per_s.x(), kSpeed, 0.08 * kSpeed);  // 1 s in six steps
  }
}

TEST(CameraRates, DoNotTakeTheAttitudesOfPhotosForTurning) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> wobble(0, 0.05);
  StampedCameras photos;
  for (int i = 0; i < 40; ++i) {
    photos.add(2.0 * i, {rotation_from_vector({wobble(random), wobble(random), wobble(random)}), {10.0 * i, 0, 0}});
  }
  for (const CameraRate& rate : photos.rates()) EXPECT_TRUE(rate.turn_per_s.isZero());
}

TEST(CameraRates, TakeNothingAcrossAPauseOrWithoutAPose) {
  StampedCameras flight;
  for (int i = 0; i < 6; ++i) flight.add(2.0 * i, {Eigen::Quaterniond::Identity(), {10.0 * i, 0, 0}});
  for (int i = 0; i < 6; ++i) flight.add(600 + 2.0 * i, {Eigen::Quaterniond::Identity(), {0, 8.0 * i, 0}});
  flight.world_from_cameras[2].reset();
  const std::vector<CameraRate> rates = flight.rates();
  for (std::size_t i = 0; i < 12; ++i) {
    const Eigen::Vector3d expected = i == 2  ? Eigen::Vector3d(0, 0, 0)
                                     : i < 6 ? Eigen::Vector3d(5, 0, 0)
                                             : Eigen::Vector3d(0, 4, 0);
    EXPECT_LT((rates[i].velocity_in_world_per_s - expected).norm(), 1e-9) << i;
  }
}

TEST(CameraRates, AreNoneForACameraAloneOrForNone) {
  EXPECT_TRUE(StampedCameras{}.rates().empty());
  StampedCameras one;
  one.add(0, {});
  EXPECT_TRUE(one.rates().front().velocity_in_world_per_s.isZero());
}

}  // namespace
}  // namespace fabloop
