// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/describe_sequence.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <utility>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;

/// Four images in a folder; those in `damaged` are cut off half way.
Sequence make_sequence(const TemporaryFolder& folder, const std::vector<std::size_t>& damaged) {
  Sequence sequence{"four", {kWidth, kHeight, 80, 80, 47.5, 35.5, DistortionModel::Radtan, {}}, {}};
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<std::uint8_t> bytes = encoded_image(".png", kWidth, kHeight);
    if (std::find(damaged.begin(), damaged.end(), i) != damaged.end()) bytes.resize(bytes.size() / 2);
    sequence.frames.push_back({folder.write(std::to_string(i) + ".png", bytes), static_cast<std::int64_t>(i), {}, {}});
  }
  return sequence;
}

TEST(DescribeSequence, LooksAtEveryImageInOrder) {
  const TemporaryFolder folder;
  const DescribedSequence described = describe_sequence(make_sequence(folder, {}));
  ASSERT_EQ(described.frames.size(), 4U);
  EXPECT_TRUE(described.damaged_frames.empty());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(described.frames[i].frame, i);
    EXPECT_GT(described.frames[i].features.keypoints.size(), 0U);
    EXPECT_EQ(described.frames[i].grey.size(), described.frames[i].features.keypoints.size());
  }
}

TEST(DescribeSequence, SkipsNamesAndCountsADamagedImage) {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  DescribeOptions options;
  options.warn = [&](const std::string& warning) { warnings.push_back(warning); };
  const DescribedSequence described = describe_sequence(make_sequence(folder, {1, 2}), options);
  EXPECT_EQ(described.damaged_frames, (std::vector<std::size_t>{1, 2}));
  ASSERT_EQ(described.frames.size(), 2U);
  EXPECT_EQ(described.frames[1].frame, 3U);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_NE(warnings[0].find("1.png"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("2.png"), std::string::npos) << warnings[1];
}

TEST(DescribeSequence, RefusesADamagedImageWhenAskedTo) {
  const TemporaryFolder folder;
  DescribeOptions options;
  options.if_damaged = IfDamaged::Refuse;
  const Sequence sequence = make_sequence(folder, {2});
  const std::string message = input_error_of([&] { describe_sequence(sequence, options); });
  EXPECT_NE(message.find("2.png"), std::string::npos) << message;
}

TEST(DescribeSequence, RefusesASequenceWithoutAReadableImage) {
  const TemporaryFolder folder;
  const Sequence sequence = make_sequence(folder, {0, 1, 2, 3});
  const std::string message = input_error_of([&] { describe_sequence(sequence); });
  EXPECT_NE(message.find("four"), std::string::npos) << message;
  EXPECT_NE(message.find("0.png"), std::string::npos) << message;
}

TEST(DescribeSequence, IsTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Sequence sequence = make_sequence(folder, {1});
  DescribeOptions one, three;
  one.num_threads = 1;
  three.num_threads = 3;
  const DescribedSequence a = describe_sequence(sequence, one);
  const DescribedSequence b = describe_sequence(sequence, three);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].grey, b.frames[i].grey);
    EXPECT_EQ(cv::norm(a.frames[i].features.descriptors, b.frames[i].features.descriptors, cv::NORM_INF), 0.0);
  }
}

}  // namespace
}  // namespace fabloop
