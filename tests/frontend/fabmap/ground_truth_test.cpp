// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frontend/npy.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

Pose at(double x, double yaw_deg = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(rad_from_deg(yaw_deg), Eigen::Vector3d::UnitY())), {x, 0, 0}};
}

TEST(GroundTruth, PosesAreJudgedByRadiusRingAngleAndWindow) {
  const std::vector<std::optional<Pose>> poses = {at(0), at(1), at(4.9), at(5), at(8), at(0, 30), at(0, 60), std::nullopt};
  const GroundTruth truth = truth_from_poses(poses, poses, 1, {.radius_m = 5, .max_angle_deg = 45, .not_judged_radius_m = 8});
  EXPECT_EQ(truth.at(0, 0), MatchTruth::NotJudged) << "itself";
  EXPECT_EQ(truth.at(0, 1), MatchTruth::NotJudged) << "in the window";
  EXPECT_EQ(truth.at(0, 2), MatchTruth::True);
  EXPECT_EQ(truth.at(0, 3), MatchTruth::NotJudged) << "in the ring";
  EXPECT_EQ(truth.at(0, 4), MatchTruth::False);
  EXPECT_EQ(truth.at(5, 0), MatchTruth::True);
  EXPECT_EQ(truth.at(6, 0), MatchTruth::False) << "looks elsewhere";
  EXPECT_EQ(truth.at(0, 7), MatchTruth::NotJudged) << "no pose";
  EXPECT_TRUE(truth.within_one_sequence);
  for (const char* figure : {"5 m", "45 deg", "8 m", "within 1 "}) EXPECT_THAT(truth.recipe, HasSubstr(figure));
}

TEST(GroundTruth, AnotherSequenceHasNoWindow) {
  const GroundTruth truth = truth_from_poses({at(0)}, {at(0), at(20)}, std::nullopt);
  EXPECT_EQ(truth.at(0, 0), MatchTruth::True);
  EXPECT_EQ(truth.at(0, 1), MatchTruth::False);
  EXPECT_EQ(truth.num_queries, 1u);
  EXPECT_EQ(truth.num_matches, 2u);
  EXPECT_FALSE(truth.within_one_sequence);
}

TEST(GroundTruth, PairsFollowTheRulesOfOverlapAndInliers) {
  const PairTruths pairs = {{{0, 2}, {0.2, 0}}, {{0, 3}, {0.0, 15}}, {{0, 4}, {0.1, 14}}, {{0, 5}, {0.04, 14}}};
  const GroundTruth truth = truth_from_pairs(pairs, {true, true, true, true, true, true, false}, 1);
  EXPECT_EQ(truth.at(2, 0), MatchTruth::True);
  EXPECT_EQ(truth.at(3, 0), MatchTruth::True);
  EXPECT_EQ(truth.at(4, 0), MatchTruth::NotJudged);
  EXPECT_EQ(truth.at(5, 0), MatchTruth::False);
  EXPECT_EQ(truth.at(5, 2), MatchTruth::False) << "an absent pair has no overlap";
  EXPECT_EQ(truth.at(6, 0), MatchTruth::NotJudged) << "no reference";
}

TEST(GroundTruth, RulesThatMakeNoSenseAreRefused) {
  EXPECT_THROW(truth_from_poses({}, {}, 1, {.radius_m = 0}), InputError);
  EXPECT_THROW(truth_from_poses({}, {}, 1, {.radius_m = 5, .not_judged_radius_m = 4}), InputError);
  EXPECT_THROW(truth_from_poses({}, {}, 1, {.max_angle_deg = 181}), InputError);
  EXPECT_THROW(truth_from_matrix({1, 2, {0, 1}}, 0), InputError) << "not square";
}

TEST(LoopMatrix, IsReadFromTextAndNumPy) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> expected = {0, 1, 1, 0, 0, 1};
  for (const char* text : {"0 1 1\n0 0 1\n", "# loops\n0,1,1\n\n0, 0, 1\r\n", "0;1.0;true\nfalse;0;1"}) {
    const LoopMatrix matrix = read_loop_matrix(folder.write("loops.txt", std::string(text)));
    EXPECT_EQ(matrix.num_queries, 2u);
    EXPECT_EQ(matrix.num_matches, 3u);
    EXPECT_EQ(matrix.entries, expected);
  }
  NpyWriter writer(folder.path() / "loops.npy", NpyType::UInt8, 3);
  writer.add_row(std::vector<double>{0, 1, 1});
  writer.add_row(std::vector<double>{0, 0, 1});
  writer.commit();
  EXPECT_EQ(read_loop_matrix(folder.path() / "loops.npy").entries, expected);
}

TEST(LoopMatrix, BadEntriesAreNamed) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    const auto path = folder.write("loops.txt", text);
    return input_error_of([&] { read_loop_matrix(path); });
  };
  EXPECT_THAT(error_of("0 1\n0 2\n"), HasSubstr("loops.txt:2: '2'"));
  EXPECT_THAT(error_of("0 1\n0\n"), HasSubstr("loops.txt:2: has 1 entries"));
  EXPECT_THAT(error_of("# nothing\n"), HasSubstr("no entries"));
  EXPECT_THROW(read_loop_matrix(folder.path() / "absent.txt"), InputError);
  NpyWriter writer(folder.path() / "loops.npy", NpyType::Float32, 2);
  writer.add_row(std::vector<double>{0, 0.5});
  writer.commit();
  EXPECT_THAT(input_error_of([&] { read_loop_matrix(folder.path() / "loops.npy"); }), HasSubstr("row 0, column 1"));
}

}  // namespace
}  // namespace fabloop
