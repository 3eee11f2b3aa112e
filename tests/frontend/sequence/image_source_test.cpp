// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/image_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kMillisecond = 1'000'000;

/// Mean grey level of a frame of write_video().
double level_of(std::size_t frame) { return 50.0 + 7.0 * static_cast<double>(frame); }

/// A video of noise, each frame brighter than the last, 10 a second.
std::filesystem::path write_video(const TemporaryFolder& folder, std::size_t num_frames) {
  const auto path = folder.path() / "video.avi";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, {64, 48}, true);
  EXPECT_TRUE(writer.isOpened());
  cv::RNG random(3);
  for (std::size_t i = 0; i < num_frames; ++i) {
    cv::Mat image(48, 64, CV_8UC3);
    random.fill(image, cv::RNG::UNIFORM, level_of(i) - 35.0, level_of(i) + 35.0);
    writer.write(image);
  }
  return path;
}

/// All images, asked for three at a time.
std::vector<SourceImage> all_of(ImageSource& source) {
  std::vector<SourceImage> images;
  for (auto block = source.next(3); !block.empty(); block = source.next(3)) {
    EXPECT_LE(block.size(), 3u);
    images.insert(images.end(), block.begin(), block.end());
  }
  EXPECT_TRUE(source.next(3).empty()) << "the end stays the end";
  return images;
}

std::vector<std::size_t> frames_of(const std::vector<SourceImage>& images) {
  std::vector<std::size_t> frames;
  for (const SourceImage& image : images) frames.push_back(image.frame);
  return frames;
}

/// A folder with five images, 100 ms apart.
void write_images(const TemporaryFolder& folder) {
  std::string csv;
  for (int i = 0; i < 5; ++i) {
    const std::string name = std::to_string(i) + ".png";
    folder.write("images/" + name, encoded_image(".png"));
    csv += name + "," + std::to_string(10 + i / 10) + "." + std::to_string(i) + "\n";
  }
  folder.write("frames.csv", csv);
}

TEST(ImageSource, GivesAFolderWithoutCalibrationInOrderOfTime) {
  const TemporaryFolder folder;
  write_images(folder);
  ImageSource source(folder.path());
  EXPECT_EQ(source.estimated_size(), 5u);
  const auto images = all_of(source);
  EXPECT_THAT(frames_of(images), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(images[3].time_ns, 10'300 * kMillisecond);
  EXPECT_EQ(images[3].gray.type(), CV_8UC1);
  EXPECT_EQ(images[3].gray.size(), cv::Size(64, 48));
}

TEST(ImageSource, GivesAVideoWithItsTimes) {
  const TemporaryFolder folder;
  ImageSource source(write_video(folder, 8));
  EXPECT_EQ(source.name(), "video.avi");
  EXPECT_EQ(source.estimated_size(), 8u);
  const auto images = all_of(source);
  ASSERT_THAT(frames_of(images), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  constexpr double kJpegLevels = 3.0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(images[i].gray.type(), CV_8UC1);
    EXPECT_NEAR(cv::mean(images[i].gray)[0], level_of(i), kJpegLevels);
    EXPECT_EQ(images[i].time_ns - images[0].time_ns, static_cast<std::int64_t>(i) * 100 * kMillisecond);
  }
}

TEST(ImageSource, TakesEveryNthImageOrSoManyASecond) {
  const TemporaryFolder folder;
  write_images(folder);
  const auto video = write_video(folder, 8);
  ImageSource third(video, {.every = 3});
  EXPECT_EQ(third.estimated_size(), 3u);
  EXPECT_THAT(frames_of(all_of(third)), ElementsAre(0, 3, 6));
  ImageSource five_a_second(video, {.max_images_per_s = 5.0});
  EXPECT_EQ(five_a_second.estimated_size(), 4u);
  EXPECT_THAT(frames_of(all_of(five_a_second)), ElementsAre(0, 2, 4, 6));
  ImageSource of_folder(folder.path(), {.every = 2});
  EXPECT_THAT(frames_of(all_of(of_folder)), ElementsAre(0, 2, 4));
  ImageSource four_a_second(folder.path(), {.max_images_per_s = 4.0});
  EXPECT_THAT(frames_of(all_of(four_a_second)), ElementsAre(0, 3));
}

TEST(ImageSource, DamagedImagesAreSkippedAndNamed) {
  const TemporaryFolder folder;
  write_images(folder);
  folder.write("images/1.png", std::string("no image"));
  std::vector<std::string> warnings;
  ImageSource source(folder.path(), {.warn = [&](const std::string& message) { warnings.push_back(message); }});
  EXPECT_THAT(frames_of(all_of(source)), ElementsAre(0, 2, 3, 4));
  EXPECT_THAT(source.damaged_frames(), ElementsAre(1));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("1.png"));
  ImageSource strict(folder.path(), {.if_damaged = IfDamaged::Refuse});
  EXPECT_THAT(input_error_of([&] { strict.next(5); }), HasSubstr("1.png"));
}

TEST(ImageSource, AFolderWithoutAnyReadableImageIsRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "b.png"}) folder.write(name, std::string("no image"));
  ImageSource source(folder.path());
  EXPECT_THAT(input_error_of([&] { source.next(1); }), HasSubstr("a.png"));
}

TEST(ImageSource, ATruncatedVideoGivesWhatItHasAndIsNamed) {
  const TemporaryFolder folder;
  const auto video = write_video(folder, 25);
  std::filesystem::resize_file(video, std::filesystem::file_size(video) / 2);
  std::vector<std::string> warnings;
  ImageSource source(video, {.warn = [&](const std::string& message) { warnings.push_back(message); }});
  const auto images = all_of(source);
  EXPECT_GT(images.size(), 2u);
  EXPECT_LT(images.size(), 23u);
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings.back(), HasSubstr("video.avi"));
  ImageSource strict(video, {.if_damaged = IfDamaged::Refuse});
  EXPECT_THAT(input_error_of([&] { all_of(strict); }), HasSubstr("video.avi"));
}

TEST(ImageSource, WhatIsNeitherFolderNorVideoIsRefused) {
  const TemporaryFolder folder;
  const auto text = folder.write("text.avi", std::string("this is no video"));
  EXPECT_THAT(input_error_of([&] { ImageSource source(text); }), HasSubstr("text.avi"));
  const auto image = folder.write("0001.png", encoded_image(".png"));
  EXPECT_THAT(input_error_of([&] { ImageSource source(image); }), HasSubstr("give the folder"));
  EXPECT_THAT(input_error_of([&] { ImageSource source(folder.path() / "absent"); }), HasSubstr("absent"));
  EXPECT_THROW(ImageSource(folder.path(), {.every = 0}), InputError);
  EXPECT_THROW(ImageSource(folder.path(), {.max_images_per_s = 0.0}), InputError);
}

}  // namespace
}  // namespace fabloop
