// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/trajectory.h"

#include <gtest/gtest.h>

#include <fstream>

#include "frontend/error.h"

namespace fabloop {
namespace {

std::filesystem::path temporary_file(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path;
}

TEST(Trajectory, TimesSurviveToTheNanosecond) {
  EXPECT_EQ(nanoseconds_from_seconds("1500000000.123456789"), 1500000000123456789);
  EXPECT_EQ(nanoseconds_from_seconds("12"), 12000000000);
  EXPECT_EQ(nanoseconds_from_seconds("-0.5"), -500000000);
  EXPECT_EQ(nanoseconds_from_seconds("1.5e9"), 1500000000000000000);
  EXPECT_FALSE(nanoseconds_from_seconds("noon").has_value());
  EXPECT_EQ(seconds_from_nanoseconds(1500000000123456789), "1500000000.123456789");
  EXPECT_EQ(seconds_from_nanoseconds(-500000000), "-0.500000000");
}

TEST(Trajectory, TumFilesRoundTrip) {
  const Pose pose{Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {1.25, -2.5, 1e-3}};
  const auto path = std::filesystem::path(testing::TempDir()) / "round_trip.tum";
  write_tum(path, {{1500000000123456789, pose}});
  const Trajectory read = read_tum(path);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].time_ns, 1500000000123456789);
  EXPECT_LT((read[0].world_from_camera.translation - pose.translation).norm(), 1e-9);
  EXPECT_LT(read[0].world_from_camera.rotation.angularDistance(pose.rotation), 1e-8);
}

TEST(Trajectory, ABadLineIsNamed) {
  for (const std::string line : {"1 0 0 0 0 0 0", "1 0 0 x 0 0 0 1", "1 0 0 nan 0 0 0 1", "1 0 0 0 0 0 0 9", "0 0 0 0 0 0 0 1"}) {
    const auto path = temporary_file("bad.tum", "# a comment\n0 0 0 0 0 0 0 1\n" + line + "\n");
    try {
      read_tum(path);
      FAIL() << "accepted: " << line;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("bad.tum:3"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace fabloop
