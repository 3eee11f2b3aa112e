// SPDX-License-Identifier: BSD-3-Clause
#include "data/sequence_trouble.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "data/world_writer.h"
#include "frontend/error.h"
#include "frontend/fabmap/pair_truth.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"
#include "tests/data/tiny_flight.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNumFrames = 40;

/// A sequence of forty small images of noise, a straight flight north-east, and the truth that every frame overlaps with the one
/// twenty later.
class SequenceTroubles : public testing::Test {
 protected:
  SequenceTroubles()
      : root_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()),
        from_(root_ / "from") {
    fs::remove_all(root_);
    fs::create_directories(from_ / "images");
    std::ofstream frames(from_ / "frames.csv"), pairs(from_ / "pairs.csv");
    Trajectory poses;
    for (std::size_t i = 0; i < kNumFrames; ++i) {
      cv::Mat image(48, 64, CV_8UC3);
      cv::RNG random(i + 1);
      random.fill(image, cv::RNG::UNIFORM, 60, 120);
      const std::string name = std::to_string(1000 + i) + ".png";
      cv::imwrite((from_ / "images" / name).string(), image);
      frames << name << ',' << i << '\n';
      if (i + 20 < kNumFrames) pairs << i << ',' << i + 20 << ",1,0.5,\n";
      Pose pose;
      pose.rotation = Eigen::Quaterniond(0, 1, 0, 0);
      pose.translation = {3.0 * static_cast<double>(i), 4.0 * static_cast<double>(i), 30.0};
      poses.push_back({static_cast<std::int64_t>(i) * 1'000'000'000, pose});
    }
    write_tum(from_ / "odometry.tum", poses);
    write_tum(from_ / "reference.tum", poses);
    std::ofstream(from_ / "camera.yaml")
        << "image_width: 64\nimage_height: 48\ncamera_matrix: {data: [50, 0, 32, 0, 51, 24, 0, 0, 1]}\n"
           "distortion_model: plumb_bob\ndistortion_coefficients: {data: [0.1, 0, 0, 0, 0]}\n";
  }
  ~SequenceTroubles() override { fs::remove_all(root_); }

  TroubledSequence trouble(const SequenceTrouble& options) {
    return write_troubled_sequence(from_, to(), options, OutputFolder::IfExists::Replace);
  }
  fs::path to() const { return root_ / "to"; }
  Sequence troubled() const { return read_sequence(to(), {.odometry = to() / "odometry.tum"}); }
  Sequence original() const { return read_sequence(from_, {.odometry = from_ / "odometry.tum"}); }
  cv::Mat image(const Frame& frame) const { return cv::imread(frame.image_path.string()); }

  fs::path root_, from_;
};

TEST_F(SequenceTroubles, WithoutAnyTheCopyIsTheSame) {
  EXPECT_TRUE(is_trouble_free({}));
  const TroubledSequence result = trouble({});
  EXPECT_EQ(result.num_frames, kNumFrames);
  EXPECT_EQ(result.num_steps, kNumFrames - 1);
  const Sequence before = original(), after = troubled();
  ASSERT_EQ(after.frames.size(), before.frames.size());
  EXPECT_NEAR(after.camera.fy, 51.0, 1e-9);
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    EXPECT_EQ(cv::norm(image(after.frames[i]), image(before.frames[i])), 0.0);
    EXPECT_LT((after.frames[i].odom_from_camera->translation - before.frames[i].odom_from_camera->translation).norm(), 1e-7);
  }
  EXPECT_EQ(read_pairs(to() / "pairs.csv").size(), read_pairs(from_ / "pairs.csv").size());
}

TEST_F(SequenceTroubles, ImagesAreSpoiledAtExactlyTheGivenRates) {
  const TroubledSequence result = trouble({.blurred_frames = 0.25, .exposed_frames = 0.1, .occluded_frames = 0.5});
  EXPECT_EQ(result.num_blurred, 10u);
  EXPECT_EQ(result.num_exposed, 4u);
  EXPECT_EQ(result.num_occluded, 20u);
}

TEST_F(SequenceTroubles, BlurTakesTheDetail) {
  trouble({.blurred_frames = 0.25, .blur_px = 3});
  const Sequence before = original(), after = troubled();
  std::size_t num_smooth = 0;
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(image(after.frames[i]), mean, deviation);
    const bool is_smooth = deviation[0] < 5.0;  // 17 before
    num_smooth += is_smooth;
    if (is_smooth) continue;
    EXPECT_EQ(cv::norm(image(after.frames[i]), image(before.frames[i])), 0.0) << "an unharmed frame is the same";
  }
  EXPECT_EQ(num_smooth, 10u);
}

TEST_F(SequenceTroubles, ExposureDoublesOrHalvesTheLightByStops) {
  trouble({.exposed_frames = 1.0, .exposure_stops = 1.0});
  const Sequence before = original(), after = troubled();
  std::size_t num_light = 0, num_dark = 0;
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    const double ratio = cv::mean(image(after.frames[i]))[0] / cv::mean(image(before.frames[i]))[0];
    num_light += std::abs(ratio - 2.0) < 0.02;
    num_dark += std::abs(ratio - 0.5) < 0.02;
  }
  EXPECT_EQ(num_light + num_dark, kNumFrames);
  EXPECT_GT(num_light, 0u);
  EXPECT_GT(num_dark, 0u);
}

TEST_F(SequenceTroubles, OcclusionCoversTheGivenAreaOfTheGivenFrames) {
  trouble({.occluded_frames = 0.5, .occluded_area = 0.25});
  std::size_t num_covered = 0;
  for (const Frame& frame : troubled().frames) {
    cv::Mat dark;
    cv::inRange(image(frame), cv::Scalar(40, 40, 40), cv::Scalar(40, 40, 40), dark);
    const double share = cv::countNonZero(dark) / (64.0 * 48.0);
    num_covered += share > 0.0;
    EXPECT_TRUE(share == 0.0 || std::abs(share - 0.25) < 1e-9) << share;
  }
  EXPECT_EQ(num_covered, 20u);
}

TEST_F(SequenceTroubles, DroppedFramesAreGoneAndPairsKeepTheirFrames) {
  const TroubledSequence result = trouble({.dropped_frames = 0.3});
  EXPECT_EQ(result.num_dropped, 12u);
  EXPECT_EQ(result.num_frames, 28u);
  const Sequence after = troubled();
  ASSERT_EQ(after.frames.size(), 28u);
  for (const auto& [frames, pair] : read_pairs(to() / "pairs.csv")) {
    // Stamps are the frames' old numbers.
    EXPECT_EQ(after.frames[frames.second].time_ns - after.frames[frames.first].time_ns, 20'000'000'000);
    EXPECT_EQ(pair.overlap, 0.5);
  }
}

TEST_F(SequenceTroubles, AWrongCalibrationIsWrongByTheGivenShare) {
  trouble({.focal_error = 0.1});
  EXPECT_NEAR(troubled().camera.fx, 55.0, 1e-9);
  EXPECT_NEAR(troubled().camera.fy, 56.1, 1e-9);
  EXPECT_EQ(troubled().camera.cx, 32.0);
}

TEST_F(SequenceTroubles, StepsSlipAtExactlyTheGivenRate) {
  const TroubledSequence result = trouble({.odometry_slips = 0.2});
  EXPECT_EQ(result.num_slips, 8u);  // of 39 steps, to the nearest
  const Sequence after = troubled();
  std::size_t num_wrong = 0;
  for (std::size_t i = 1; i < kNumFrames; ++i) {
    const Pose step = after.frames[i - 1].odom_from_camera->inverse() * *after.frames[i].odom_from_camera;
    const bool is_wrong = std::abs(step.translation.norm() - 5.0) > 1e-6 || rotation_angle(step.rotation) > 1e-6;
    num_wrong += is_wrong;
    EXPECT_LE(step.translation.norm(), 10.0 + 1e-6);
    EXPECT_LE(deg_from_rad(rotation_angle(step.rotation)), 20.0 + 1e-6);
  }
  EXPECT_EQ(num_wrong, 8u);
}

TEST_F(SequenceTroubles, NoiseHasTheGivenDeviation) {
  trouble({.odometry_translation_noise = 0.05, .odometry_rotation_noise_deg = 0.4});
  const Sequence before = original(), after = troubled();
  double translation = 0.0, rotation = 0.0;
  for (std::size_t i = 1; i < kNumFrames; ++i) {
    const Pose step = after.frames[i - 1].odom_from_camera->inverse() * *after.frames[i].odom_from_camera;
    const Pose truth = before.frames[i - 1].odom_from_camera->inverse() * *before.frames[i].odom_from_camera;
    translation += (step.translation - truth.translation).squaredNorm() / (3.0 * 39.0);
    rotation += std::pow(deg_from_rad(rotation_angle(step.rotation * truth.rotation.conjugate())), 2) / (3.0 * 39.0);
  }
  // 117 draws: their deviation is known to 7 %, and three times that is 20 %.
  EXPECT_NEAR(std::sqrt(translation), 0.25, 0.05);
  EXPECT_NEAR(std::sqrt(rotation), 0.4, 0.08);
}

TEST_F(SequenceTroubles, TheSameSeedSpoilsTheSameFrames) {
  const auto names_at = [&](std::uint64_t seed) {
    trouble({.seed = seed, .dropped_frames = 0.4});
    std::ostringstream frames;
    frames << std::ifstream(to() / "frames.csv").rdbuf();
    return frames.str();
  };
  const std::string first = names_at(1);
  EXPECT_EQ(names_at(1), first);
  EXPECT_NE(names_at(2), first);
}

TEST_F(SequenceTroubles, BadOptionsAreRefusedAndLeaveNothing) {
  EXPECT_THROW(trouble({.dropped_frames = 1.0}), InputError) << "no frame would be left";
  EXPECT_THROW(trouble({.blurred_frames = 1.5}), InputError);
  EXPECT_THROW(trouble({.focal_error = -1.0}), InputError);
  EXPECT_THROW(trouble({.odometry_slips = -0.1}), InputError);
  EXPECT_FALSE(fs::exists(to()));
}

}  // namespace
}  // namespace fabloop
