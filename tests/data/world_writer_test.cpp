// SPDX-License-Identifier: BSD-3-Clause
#include "data/world_writer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "frontend/error.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"
#include "tests/data/tiny_flight.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

/// An empty folder of its own for each test, gone afterwards.
class WorldWriter : public testing::Test {
 protected:
  WorldWriter() : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
  }
  ~WorldWriter() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(WorldWriter, WritesWhatIsReadBack) {
  SyntheticFlightOptions options = tiny_flight_options();
  options.depth_images = DepthImages::Written;
  const SyntheticFlight flight = write_synthetic_flight(folder_ / "meadow", options);
  const Trajectory reference = read_tum(folder_ / "meadow" / "reference.tum");
  const Trajectory odometry = read_tum(folder_ / "meadow" / "odometry.tum");
  ASSERT_EQ(reference.size(), flight.world_from_camera.size());
  ASSERT_EQ(odometry.size(), flight.world_from_camera.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    EXPECT_LT((reference[i].world_from_camera.translation - flight.world_from_camera[i].translation).norm(), 1e-8);
    EXPECT_LT(rotation_angle(reference[i].world_from_camera.rotation.conjugate() * flight.world_from_camera[i].rotation), 1e-7);
    EXPECT_LT((odometry[i].world_from_camera.translation - flight.odom_from_camera[i].translation).norm(), 1e-8);
  }
  SequenceOptions sequence_options;
  sequence_options.odometry = folder_ / "meadow" / "odometry.tum";
  const Sequence sequence = read_sequence(folder_ / "meadow", sequence_options);
  ASSERT_EQ(sequence.frames.size(), reference.size());
  EXPECT_NEAR(sequence.camera.fx, options.camera.fx, 1e-6);
  EXPECT_NEAR(sequence.camera.distortion.at(0), options.camera.distortion.at(0), 1e-9);
  for (const auto& frame : sequence.frames) {
    EXPECT_TRUE(frame.odom_from_camera.has_value());
    EXPECT_EQ(read_gray_image(frame.image_path, sequence.camera).cols, options.camera.width);
  }
  const cv::Mat depth = cv::imread((folder_ / "meadow" / "depth" / "0000.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16UC1);
  EXPECT_NEAR(cv::mean(depth)[0] * 0.001, flight.world_from_camera[0].translation.z(), 3);
}

TEST_F(WorldWriter, DoesNotDependOnTheNumberOfThreads) {
  SyntheticFlightOptions options = tiny_flight_options();
  options.num_threads = 1;
  write_synthetic_flight(folder_ / "one", options);
  options.num_threads = 3;
  write_synthetic_flight(folder_ / "three", options);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "one")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder_ / "three" / fs::relative(entry.path(), folder_ / "one"))) << entry.path();
  }
  EXPECT_GT(files, 12);
}

TEST_F(WorldWriter, RefusesAFolderThatExistsUnlessItIsToBeReplaced) {
  fs::create_directories(folder_ / "taken");
  std::ofstream(folder_ / "taken" / "mine.txt") << "mine";
  EXPECT_THROW(write_synthetic_flight(folder_ / "taken", tiny_flight_options()), InputError);
  EXPECT_TRUE(fs::exists(folder_ / "taken" / "mine.txt"));
  write_synthetic_flight(folder_ / "taken", tiny_flight_options(), OutputFolder::IfExists::Replace);
  EXPECT_FALSE(fs::exists(folder_ / "taken" / "mine.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "taken" / "pairs.csv"));
}

TEST_F(WorldWriter, LeavesNothingHalfWritten) {
  SyntheticFlightOptions options = tiny_flight_options();
  options.progress = [](std::string_view stage, std::size_t, std::size_t) {
    if (stage == "images") throw InputError("stopped");
  };
  EXPECT_THROW(write_synthetic_flight(folder_ / "meadow", options), InputError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(WorldWriter, RefusesBadOptions) {
  SyntheticFlightOptions options = tiny_flight_options();
  options.jpeg_quality = 0;
  EXPECT_THROW(write_synthetic_flight(folder_ / "a", options), InputError);
  options = tiny_flight_options();
  options.flight.length_m = -5;
  EXPECT_THROW(write_synthetic_flight(folder_ / "b", options), InputError);
}

}  // namespace
}  // namespace fabloop
