// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/csv_lines.h"
#include "frontend/stage_times.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

/// Images of the frames 0, 2, 4, ... at the seconds 10, 12, 14, ...: every second one of a sequence.
std::vector<ObservedImage> every_second_image(std::size_t count) {
  std::vector<ObservedImage> images;
  for (std::size_t i = 0; i < count; ++i) images.push_back({2 * i, static_cast<std::int64_t>(10 + 2 * i) * 1'000'000'000, {}});
  return images;
}

constexpr const char* kReference = "10 0 0 0 0 0 0 1\n11 1 0 0 0 0 0 1\n12 2 0 0 0 0 0 1\n14 40 0 0 0 0 0 1\n";

TEST(RecognitionTruth, AFolderGivesItsPairsElseItsPoses) {
  const TemporaryFolder folder;
  folder.write("reference.tum", std::string(kReference));
  const RecognitionTruthOptions options{.exclusion_window = 1};
  const GroundTruth by_poses = read_truth(folder.path(), every_second_image(3), options);
  EXPECT_EQ(by_poses.num_queries, 5u);
  EXPECT_EQ(by_poses.at(2, 0), MatchTruth::True);
  EXPECT_EQ(by_poses.at(4, 0), MatchTruth::False);
  EXPECT_EQ(by_poses.at(4, 1), MatchTruth::NotJudged) << "frame 1 was not looked at";
  folder.write("pairs.csv", std::string("0,4,40,0.5,\n"));
  const GroundTruth by_pairs = read_truth(folder.path(), every_second_image(3), options);
  EXPECT_EQ(by_pairs.at(4, 0), MatchTruth::True);
  EXPECT_EQ(by_pairs.at(2, 0), MatchTruth::False);
  EXPECT_EQ(read_truth(folder.path() / "pairs.csv", every_second_image(3), options).at(4, 0), MatchTruth::True);
  EXPECT_EQ(read_truth(folder.path() / "reference.tum", every_second_image(3), options).at(4, 0), MatchTruth::False);
}

TEST(RecognitionTruth, AMatrixIsToldFromPoses) {
  const TemporaryFolder folder;
  const auto matrix = folder.write("truth.txt", std::string("# loops\n0 0 1\n0 0 0\n1 0 0\n"));
  EXPECT_EQ(read_truth(matrix, every_second_image(2), {.exclusion_window = 0}).at(2, 0), MatchTruth::True);
  const auto poses = folder.write("truth.tum", std::string("10 0 0 0 0 0 0 1\n12 0 0 0 0 0 0 1\n"));
  EXPECT_EQ(read_truth(poses, every_second_image(2), {.exclusion_window = 0}).at(2, 0), MatchTruth::True);
}

TEST(RecognitionTruth, AMapNeedsPosesOfItsOwnOrAMatrix) {
  const TemporaryFolder folder;
  const auto poses = folder.write("reference.tum", std::string(kReference));
  const auto queries = every_second_image(3);
  const auto map = every_second_image(1);
  EXPECT_THAT(input_error_of([&] { read_truth_in_map(poses, queries, {}, map); }), HasSubstr("--map-truth"));
  const GroundTruth truth = read_truth_in_map(folder.path(), queries, poses, map);
  EXPECT_EQ(truth.at(0, 0), MatchTruth::True) << "another time, so no window";
  EXPECT_EQ(truth.at(4, 0), MatchTruth::False);
  const auto matrix = folder.write("truth.csv", std::string("1,0\n"));
  EXPECT_EQ(read_truth_in_map(matrix, map, {}, map).num_matches, 2u);
}

TEST(RecognitionTruth, WhatIsNoTruthIsRefused) {
  const TemporaryFolder folder;
  const auto images = every_second_image(2);
  EXPECT_THAT(input_error_of([&] { read_truth(folder.path(), images); }), HasSubstr("no truth"));
  EXPECT_THAT(input_error_of([&] { read_truth(folder.path() / "absent", images); }), HasSubstr("absent"));
  const auto elsewhere = folder.write("other.tum", std::string("100 0 0 0 0 0 0 1\n"));
  EXPECT_THAT(input_error_of([&] { read_truth(elsewhere, images); }), HasSubstr("another sequence"));
}

TEST(StageTimes, ArePercentilesByNearestRank) {
  const StageTimes times = stage_times({0.004, 0.001, 0.003, 0.002});
  EXPECT_EQ(times.count, 4u);
  EXPECT_DOUBLE_EQ(times.p50_ms, 2.0);
  EXPECT_DOUBLE_EQ(times.p99_ms, 4.0);
  EXPECT_DOUBLE_EQ(times.max_ms, 4.0);
  EXPECT_DOUBLE_EQ(times.total_s, 0.01);
  EXPECT_EQ(stage_times({}).total_s, 0.0);
}

TEST(CsvLines, BlanksAndCommentsAreLeftOutAndLinesNamed) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.csv", std::string("# head\n\n 1 , two,\r\nx\n"));
  std::vector<CsvFields> lines;
  const auto read = [&] {
    for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
      lines.push_back(fields);
      parse_position(fields[0], fail);
    });
  };
  EXPECT_THAT(input_error_of(read), HasSubstr("a.csv:4: 'x'"));
  EXPECT_EQ(lines[0], (CsvFields{"1", "two", ""}));
}

}  // namespace
}  // namespace fabloop
