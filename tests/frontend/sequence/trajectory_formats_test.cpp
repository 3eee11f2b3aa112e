// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/trajectory_formats.h"

#include <gtest/gtest.h>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

const Trajectory kTrajectory = {{1'500'000'000'000'000'001, {Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {1.25, -2.5, 1e-3}}},
                                {1'500'000'000'100'000'002, {rotation_from_vector({0.3, -1.2, 2.0}), {1.0 / 3.0, 1e5, -7.0}}},
                                {1'500'000'000'200'000'003, {rotation_from_vector({0.0, 0.0, 3.1}), {0.0, 0.0, 0.0}}}};

void expect_same(const Trajectory& read, double tolerance) {
  ASSERT_EQ(read.size(), kTrajectory.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time_ns, kTrajectory[i].time_ns);
    const Pose& expected = kTrajectory[i].world_from_camera;
    EXPECT_LE((read[i].world_from_camera.translation - expected.translation).norm(), tolerance);
    EXPECT_LE(rotation_angle(read[i].world_from_camera.rotation.conjugate() * expected.rotation), tolerance);
  }
}

TEST(TrajectoryFormats, RoundTripAndAreRecognised) {
  const TemporaryFolder folder;
  // TUM files have nine decimals; the others as many digits as a number has, and KITTI's matrices a little rounding.
  const std::vector<std::pair<TrajectoryFormat, double>> formats = {
      {TrajectoryFormat::Tum, 1e-8}, {TrajectoryFormat::Kitti, 1e-14}, {TrajectoryFormat::Euroc, 1e-14}};
  for (const auto& [format, tolerance] : formats) {
    const auto path = folder.path() / "poses.txt";
    write_trajectory(path, kTrajectory, format);
    EXPECT_EQ(detect_trajectory_format(path), format);
    expect_same(read_trajectory(path, format), tolerance);
  }
}

TEST(TrajectoryFormats, EurocsGroundTruthHasMoreColumns) {
  const TemporaryFolder folder;
  const auto path = folder.write("data.csv",
                                 "#timestamp, p_RS_R_x [m], ...\n"
                                 "1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152,"
                                 "-0.027876,0.033207,0.800006,-0.003172,0.021267,0.078502,-0.025266,0.136696,0.075593\n");
  EXPECT_EQ(detect_trajectory_format(path), TrajectoryFormat::Euroc);
  const Trajectory read = read_euroc(path);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].time_ns, 1403636580838555648) << "a double would lose the last digits";
  EXPECT_NEAR(read[0].world_from_camera.rotation.w(), 0.534108, 1e-6) << "w comes first";
  EXPECT_NEAR(read[0].world_from_camera.rotation.z(), -0.082152, 1e-6);
}

TEST(TrajectoryFormats, MistakesAreNamedWithFileAndLine) {
  const TemporaryFolder folder;
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  folder.write("times.txt", "0\n0.1\n");
  const auto refused = [&](const std::string& text, const std::string& what) {
    const auto path = folder.write("poses.txt", text);
    const std::string message = input_error_of([&] { read_kitti(path); });
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  refused(identity + "1 0 0 0 0 1 0 0 0 0 1\n", "poses.txt:2: has 11 columns");
  refused(identity + "1 0 0 0 0 1 0 0 0 0 -1 0\n", "poses.txt:2: the first three columns are no rotation");
  refused(identity + "2 0 0 0 0 1 0 0 0 0 1 0\n", "no rotation");
  refused(identity + "1 0 0 nan 0 1 0 0 0 0 1 0\n", "not a finite number");
  refused(identity + identity + identity, "poses.txt:3: has no time");
  refused(identity, "has 2 times for 1 poses");
  refused("", "has no poses");
  folder.write("times.txt", "0\n0\n");
  refused(identity + identity, "the time does not ascend");
  const auto euroc = folder.write("data.csv", "1.5,0,0,0,1,0,0,0\n");
  EXPECT_NE(input_error_of([&] { read_euroc(euroc); }).find("data.csv:1: '1.5' is no whole number"), std::string::npos);
  folder.write("data.csv", "1,0,0,0,2,0,0,0\n");
  EXPECT_NE(input_error_of([&] { read_euroc(euroc); }).find("unit length"), std::string::npos);
  const auto other = folder.write("other.txt", "a word\n");
  EXPECT_NE(input_error_of([&] { detect_trajectory_format(other); }).find("is no trajectory"), std::string::npos);
}

}  // namespace
}  // namespace fabloop
