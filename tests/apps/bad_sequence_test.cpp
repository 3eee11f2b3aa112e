// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/map_run.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// A folder with a sequence to spoil, and an empty one to write to.
class BadSequence : public testing::Test {
 protected:
  BadSequence() : sequence_(scratch_.path() / "flight"), out_folder_(scratch_.path() / "out") {
    copy_tiny_sequence(sequence_, 8);
    fs::create_directory(out_folder_);
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(sequence_ / name) << text; }

  void expect_map_refused(const std::string& culprit, const std::vector<std::string>& more = kFewFeatures) const {
    expect_refused(run_fabloop(map_command(sequence_, out_folder_ / "run", more)), culprit);
    expect_empty(out_folder_);
  }

  /// The damaged image is named in a note, skipped, and counted.
  void expect_skipped(const std::string& image) const {
    std::vector<std::string> command = map_command(sequence_, out_folder_ / "run", kFewFeatures);
    std::erase(command, "--quiet");
    const ProgramResult result = run_fabloop(command);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find(image), std::string::npos) << result.err;
    const auto frames = nlohmann::json::parse(bytes_of(out_folder_ / "run" / "summary.json")).at("frames");
    EXPECT_EQ(frames.at("damaged"), 1);
    EXPECT_EQ(frames.at("mapped"), frames.at("images").get<int>() - 1);
  }

  void truncate(const std::string& image) const {
    const fs::path path = sequence_ / "images" / image;
    fs::resize_file(path, fs::file_size(path) / 2);
  }

  test::ScratchFolder scratch_;
  fs::path sequence_;
  fs::path out_folder_;
};

TEST_F(BadSequence, AMissingFolderIsRefused) {
  fs::remove_all(sequence_);
  expect_map_refused(sequence_.string());
}

TEST_F(BadSequence, AFolderWithoutImagesIsRefused) {
  fs::remove_all(sequence_ / "images");
  expect_map_refused(sequence_.string());
}

TEST_F(BadSequence, AnUnreadableImageIsSkippedAndCounted) {
  write("images/0003.jpg", "this is no image");
  expect_skipped("0003.jpg");
}

TEST_F(BadSequence, ATruncatedImageIsSkippedAndCounted) {
  truncate("0003.jpg");
  expect_skipped("0003.jpg");
}

TEST_F(BadSequence, AnUnreadableImageIsRefusedUnderStrict) {
  write("images/0003.jpg", "this is no image");
  expect_map_refused("0003.jpg", {"--strict"});
}

TEST_F(BadSequence, ATruncatedImageIsRefusedUnderStrict) {
  truncate("0003.jpg");
  expect_map_refused("0003.jpg", {"--strict"});
}

TEST_F(BadSequence, ASequenceWithoutAnyReadableImageIsRefused) {
  for (const auto& image : fs::directory_iterator(sequence_ / "images")) std::ofstream(image.path()) << "this is no image";
  expect_map_refused("0000.jpg");
}

TEST_F(BadSequence, AnUnreadableImageIsRefusedByTrain) {
  write("images/0003.jpg", "this is no image");
  expect_refused(run_fabloop({"train", sequence_.string(), "--out", (out_folder_ / "model").string(), "--quiet"}), "0003.jpg");
  expect_empty(out_folder_);
}

TEST_F(BadSequence, OdometryOfAnotherTimeIsRefused) {
  write("odometry.tum", "100 0 0 0 0 0 0 1\n101 1 0 0 0 0 0 1\n");
  expect_map_refused("odometry.tum");
}

TEST_F(BadSequence, OdometryOfOneFrameAloneIsRefused) {
  const std::string lines = bytes_of(sequence_ / "odometry.tum");
  write("odometry.tum", lines.substr(0, lines.find('\n', lines.find("1500")) + 1));
  expect_map_refused("flight");
}

TEST_F(BadSequence, MissingOdometryIsRefused) {
  fs::remove(sequence_ / "odometry.tum");
  expect_map_refused("odometry.tum");
}

TEST_F(BadSequence, NoOdometryAtAllIsNoFault) {
  const auto run = out_folder_ / "run";
  EXPECT_EQ(run_fabloop({"map", sequence_.string(), "--out", run.string(), "--quiet"}).exit_code, 0);
  for (const char* name : {"trajectory.tum", "loops.csv", "summary.json", "colmap/images.txt"}) {
    EXPECT_TRUE(std::filesystem::exists(run / name)) << name;
  }
}

TEST_F(BadSequence, ABrokenOdometryLineIsRefused) {
  write("odometry.tum", "1500000000.0 0 0 0 0 0 0 1\n1500000000.8 1 0 zero 0 0 0 1\n");
  expect_map_refused("odometry.tum:2");
}

TEST_F(BadSequence, ACalibrationOfAnotherImageSizeIsRefused) {
  std::string text = bytes_of(sequence_ / "camera.yaml");
  const std::string width = "image_width: 240";
  ASSERT_NE(text.find(width), std::string::npos) << text;
  text.replace(text.find(width), width.size(), "image_width: 320");
  write("camera.yaml", text);
  expect_map_refused("320x180");
}

TEST_F(BadSequence, ACalibrationThatIsNotYamlIsRefused) {
  write("camera.yaml", "{ [ this: is: no: yaml");
  expect_map_refused("camera.yaml");
}

TEST_F(BadSequence, ACalibrationWithoutFocalLengthIsRefused) {
  write("camera.yaml", "image_width: 240\nimage_height: 180\ncamera_matrix: {data: [0, 0, 120, 0, 0, 90, 0, 0, 1]}\n");
  expect_map_refused("camera.yaml");
}

TEST_F(BadSequence, AnAbsentCalibrationWithoutExifIsRefused) {
  fs::remove(sequence_ / "camera.yaml");
  expect_map_refused("camera.yaml");
}

TEST_F(BadSequence, FramesThatDoNotExistAreRefused) {
  write("frames.csv", "0000.jpg,1500000000.0\n9999.jpg,1500000000.8\n");
  expect_map_refused("frames.csv:2");
}

}  // namespace
}  // namespace fabloop
