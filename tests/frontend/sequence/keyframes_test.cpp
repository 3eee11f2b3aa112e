// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "frontend/sequence/keyframe_choice.h"
#include "frontend/sequence/keyframe_folder.h"
#include "frontend/sequence/stamped_images.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

const cv::Size kSize(480, 360);

/// Blobs of all sizes, so that corners are found at any magnification.
cv::Mat ground(cv::Size size) {
  cv::RNG random(5);
  cv::Mat sum(size, CV_32F, cv::Scalar(0));
  for (const double blur : {2.0, 6.0, 18.0}) {
    cv::Mat noise(size, CV_32F);
    random.fill(noise, cv::RNG::UNIFORM, -1.0, 1.0);
    cv::GaussianBlur(noise, noise, {}, blur);
    sum += noise * blur;
  }
  cv::Mat image;
  cv::normalize(sum, image, 0, 255, cv::NORM_MINMAX, CV_8U);
  return image;
}

/// What a camera sees whose picture begins at `x`.
cv::Mat seen_at(const cv::Mat& strip, double x) {
  cv::Mat image;
  cv::getRectSubPix(strip, kSize, {static_cast<float>(x + kSize.width / 2.0), static_cast<float>(strip.rows / 2.0)}, image);
  return image;
}

std::vector<int> keyframes(KeyframeChoice choice, int num_images, const std::function<cv::Mat(int)>& image) {
  std::vector<int> chosen;
  for (int i = 0; i < num_images; ++i) {
    if (choice.takes(image(i))) chosen.push_back(i);
  }
  return chosen;
}

TEST(KeyframeChoice, OverlapOfAFlightIsTheOneAskedFor) {
  const cv::Mat strip = ground({1200, 400});
  // 23 steps share 85 % of 480 pixels, and the next one less.
  KeyframeChoice choice({.max_overlap = 0.85});
  EXPECT_EQ(keyframes(choice, 100, [&](int i) { return seen_at(strip, 3.1 * i); }), (std::vector<int>{0, 24, 48, 72, 96}));
  EXPECT_EQ(keyframes(KeyframeChoice({.max_overlap = 0.7}), 100, [&](int i) { return seen_at(strip, 3.1 * i); }),
            (std::vector<int>{0, 47, 94}));
}

TEST(KeyframeChoice, PhotographsOfAFlightAreAllKept) {
  const cv::Mat strip = ground({3000, 400});
  EXPECT_EQ(keyframes(KeyframeChoice(), 10, [&](int i) { return seen_at(strip, 120.0 * i); }).size(), 10u);
}

TEST(KeyframeChoice, SizeOfTheImagesDoesNotMatter) {
  const cv::Mat strip = ground({1200, 400});
  const auto large = [&](int i) {
    cv::Mat image;
    cv::resize(seen_at(strip, 3.1 * i), image, {}, 3, 3, cv::INTER_CUBIC);
    return image;
  };
  const std::vector<int> chosen = keyframes(KeyframeChoice(), 60, large);
  ASSERT_EQ(chosen.size(), 3u);
  EXPECT_NEAR(chosen[1], 24, 1);
  EXPECT_NEAR(chosen[2], 48, 2);
}

TEST(KeyframeChoice, StandingStillAddsNothing) {
  const cv::Mat strip = ground({600, 400});
  cv::RNG random(1);
  const auto noisy = [&](int) {
    cv::Mat noise(kSize, CV_16S), image;
    random.fill(noise, cv::RNG::NORMAL, 0, 4);
    cv::add(seen_at(strip, 20), noise, image, cv::noArray(), CV_8U);
    return image;
  };
  EXPECT_EQ(keyframes(KeyframeChoice(), 60, noisy), std::vector<int>{0});
}

TEST(KeyframeChoice, ForwardMotionCountsTheAreaThatIsMagnified) {
  const cv::Mat scene = ground({960, 720});
  // 1 % nearer with every image: the area shared is 1 / 1.02 of the last keyframe's after one, 0.85 after eight.
  const auto nearer = [&](int i) {
    const double scale = 0.6 * std::pow(1.01, i);
    cv::Mat image;
    const cv::Matx23d map(scale, 0, kSize.width / 2.0 - scale * 480, 0, scale, kSize.height / 2.0 - scale * 360);
    cv::warpAffine(scene, image, map, kSize);
    return image;
  };
  const std::vector<int> chosen = keyframes(KeyframeChoice({.max_overlap = 0.85}), 30, nearer);
  ASSERT_EQ(chosen.size(), 4u);
  for (std::size_t k = 1; k < chosen.size(); ++k) EXPECT_NEAR(chosen[k] - chosen[k - 1], 9, 1);
}

TEST(KeyframeChoice, ACutBeginsAnew) {
  const cv::Mat strip = ground({3000, 400});
  const auto cut = [&](int i) { return seen_at(strip, i < 7 ? 10 : 1500); };
  KeyframeChoice choice;
  EXPECT_EQ(keyframes(choice, 12, cut), (std::vector<int>{0, 7}));
}

TEST(KeyframeChoice, WhatCannotBeFollowedIsKept) {
  const cv::Mat plain(kSize, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(keyframes(KeyframeChoice(), 3, [&](int) { return plain; }).size(), 3u);
}

TEST(KeyframeChoice, SharesMustBeShares) {
  EXPECT_THAT(input_error_of([] { KeyframeChoice({.max_overlap = 1.0}); }), HasSubstr("overlap of keyframes"));
  EXPECT_THAT(input_error_of([] { KeyframeChoice({.min_followed = 0.0}); }), HasSubstr("followed"));
}

TEST(KeyframeFolder, AVideoBecomesASequence) {
  const TemporaryFolder folder;
  const cv::Mat strip = ground({1200, 400});
  {
    cv::VideoWriter video((folder.path() / "flight.avi").string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, kSize,
                          true);
    for (int i = 0; i < 60; ++i) {
      cv::Mat colour;
      cv::cvtColor(seen_at(strip, 3.1 * i), colour, cv::COLOR_GRAY2BGR);
      colour -= cv::Scalar(40, 0, 0);
      video.write(colour);
    }
  }
  const auto camera =
      folder.write("cam.yaml",
                   "image_width: 480\nimage_height: 360\ncamera_matrix: {rows: 3, cols: 3, data: [400, 0, 240, 0, 400, "
                   "180, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, "
                   "0, 0, 0, 0]}\n");
  const KeyframeCount count = write_keyframe_folder(folder.path() / "flight.avi", folder.path() / "flight", {.camera = camera});
  EXPECT_EQ(count.num_images, 60u);
  EXPECT_EQ(count.num_keyframes, 3u);
  const std::vector<StampedPath> images = list_stamped_images(folder.path() / "flight");
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[1].path.filename(), "frame_000024.jpg");
  EXPECT_EQ(images[1].time_ns, 1'200'000'000);
  const cv::Mat image = cv::imread(images[1].path.string());
  EXPECT_EQ(image.size(), kSize);
  const cv::Scalar mean = cv::mean(image);
  EXPECT_GT(mean[1], mean[0] + 20) << "colours are kept";
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "flight/camera.yaml"));
}

TEST(KeyframeFolder, AFolderKeepsItsFilesAndWhatGoesWithThem) {
  const TemporaryFolder folder;
  const cv::Mat strip = ground({1200, 400});
  std::string csv;
  for (int i = 0; i < 40; ++i) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", seen_at(strip, 3.1 * i), bytes);
    folder.write("in/images/" + std::to_string(i) + ".png", bytes);
    csv += std::to_string(i) + ".png," + std::to_string(1500000000 + i) + ".125\n";
  }
  folder.write("in/frames.csv", csv);
  folder.write("in/odometry.tum", "1500000000.125 0 0 0 0 0 0 1\n");
  folder.write("in/pairs.csv", "0,30,1,0.5,20\n");
  const KeyframeCount count = write_keyframe_folder(folder.path() / "in", folder.path() / "out");
  EXPECT_EQ(count.num_keyframes, 2u);
  const std::vector<StampedPath> images = list_stamped_images(folder.path() / "out");
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[1].path.filename(), "24.png");
  EXPECT_EQ(images[1].time_ns, 1'500'000'024'125'000'000);
  EXPECT_EQ(std::filesystem::file_size(images[1].path), std::filesystem::file_size(folder.path() / "in/images/24.png"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/odometry.tum"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/pairs.csv")) << "it counts images";
}

TEST(KeyframeFolder, NeverReplacesWhatItIsMadeOf) {
  const TemporaryFolder folder;
  folder.write("in/images/0.png", encoded_image(".png"));
  folder.write("in/cam.yaml", std::string("x"));
  for (const char* out : {"in", "in/", "."}) {
    EXPECT_THAT(input_error_of([&] {
                  write_keyframe_folder(folder.path() / "in", folder.path() / out,
                                        {.if_exists = OutputFolder::IfExists::Replace});
                }),
                HasSubstr("give another folder"))
        << out;
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "in/images/0.png"));
  EXPECT_NO_THROW(write_keyframe_folder(folder.path() / "in", folder.path() / "in/keyframes"));
}

TEST(KeyframeFolder, TellsOfImagesThatItSkips) {
  const TemporaryFolder folder;
  folder.write("in/0.png", encoded_image(".png"));
  folder.write("in/1.png", std::string("no image"));
  std::vector<std::string> warnings;
  const KeyframeCount count = write_keyframe_folder(folder.path() / "in", folder.path() / "out",
                                                    {.warn = [&](const std::string& text) { warnings.push_back(text); }});
  EXPECT_EQ(count.num_images, 1u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("1.png"));
}

TEST(KeyframeFolder, TimesBeforeTheEpochAreTimes) {
  const TemporaryFolder folder;
  folder.write("in/a.png", encoded_image(".png"));
  folder.write("in/frames.csv", std::string("a.png,-1.500000001\n"));
  write_keyframe_folder(folder.path() / "in", folder.path() / "out");
  EXPECT_EQ(list_stamped_images(folder.path() / "out").at(0).time_ns, -1'500'000'001);
}

TEST(KeyframeFolder, NamesThatALineCannotHoldAreRefused) {
  const TemporaryFolder folder;
  folder.write("in/a,b.png", encoded_image(".png"));
  EXPECT_THAT(input_error_of([&] { write_keyframe_folder(folder.path() / "in", folder.path() / "out"); }), HasSubstr("rename"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(KeyframeFolder, NothingIsLeftOfWhatFails) {
  const TemporaryFolder folder;
  folder.write("in/0.png", encoded_image(".png"));
  folder.write("in/1.png", std::string("no image"));
  EXPECT_THAT(input_error_of(
                  [&] { write_keyframe_folder(folder.path() / "in", folder.path() / "out", {.if_damaged = IfDamaged::Refuse}); }),
              HasSubstr("1.png"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.part"));
}

}  // namespace
}  // namespace fabloop
