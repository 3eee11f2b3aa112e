// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/loop_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using test::message_of;
using test::ScratchFolder;
using testing::HasSubstr;

const std::string kHead = "query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw,extra\n";

TEST(LoopTruth, ReadsHypothesesByTheNamesOfTheColumns) {
  const ScratchFolder folder;
  const auto loops = read_loops(folder.write("loops.csv", "# comment\n" + kHead +
                                                              "30,2,0.9,Accepted,100,50,1,1,2,3,0,0,0,1,x\n"
                                                              "31,3,0.9,TooFewMatches,4,,0,,,,,,,,x\n"));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_TRUE(loops[0].accepted());
  EXPECT_TRUE(loops[0].has_scale);
  EXPECT_EQ(loops[0].query, 30u);
  EXPECT_EQ(loops[0].match_from_query->translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(loops[1].accepted());
  EXPECT_FALSE(loops[1].match_from_query);
}

TEST(LoopTruth, ABadLineOfLoopsIsNamed) {
  const ScratchFolder folder;
  for (const std::string line : {"30,2,0.9,Accepted,100,50,1,1,2,3,0,0,0,1", "a,2,0.9,Accepted,100,50,1,1,2,3,0,0,0,1,x",
                                 "30,-2,0.9,Accepted,100,50,1,1,2,3,0,0,0,1,x", "30,2,0.9,Accepted,100,50,yes,1,2,3,0,0,0,1,x",
                                 "30,2,0.9,Accepted,100,50,1,,2,3,0,0,0,1,x", "30,2,0.9,Accepted,100,50,1,nan,2,3,0,0,0,1,x",
                                 "30,2,0.9,Accepted,100,50,1,1,2,3,0,0,0,9,x"}) {
    const auto path = folder.write("loops.csv", kHead + line + "\n");
    EXPECT_THAT(message_of<InputError>([&] { read_loops(path); }), HasSubstr("loops.csv:2: ")) << line;
  }
  const auto headless = folder.write("loops.csv", "query,match\n1,2\n");
  EXPECT_THAT(message_of<InputError>([&] { read_loops(headless); }), HasSubstr("no column 'verdict'"));
  EXPECT_THROW(read_loops(folder.write("loops.csv", "")), InputError);
  EXPECT_THROW(read_loops(folder.path() / "absent.csv"), InputError);
}

TEST(LoopTruth, ReadsASequenceFolder) {
  const ScratchFolder folder;
  folder.write("frames.csv", "# filename,timestamp_s\na.jpg,10.000\nb.jpg,11.000\nc.jpg,12.5\n");
  folder.write("reference.tum", "10.0 1 2 3 0 0 0 1\n12.495 4 5 6 0 0 0 1\n");
  LoopTruth truth = read_loop_truth(folder.path());
  ASSERT_EQ(truth.world_from_camera.size(), 3u);
  EXPECT_TRUE(truth.world_from_camera[0]);
  EXPECT_FALSE(truth.world_from_camera[1]);
  EXPECT_EQ(truth.world_from_camera[2]->translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(truth.pairs);
  folder.write("pairs.csv", "# i,j,...\n0,2,1.5,0.3,20\n1,2,1.5,,\n");
  truth = read_loop_truth(folder.path());
  ASSERT_TRUE(truth.pairs);
  EXPECT_EQ(truth.pairs->at({0, 2}).num_inliers, 20u);
  EXPECT_EQ(truth.pairs->at({1, 2}).overlap, 0.0);
}

TEST(LoopTruth, LoopsIntoAnEarlierMapAreLeftOut) {
  const ScratchFolder folder;
  const auto loops = folder.write("loops.csv",
                                  "query,match,verdict,has_scale,tx,ty,tz,qx,qy,qz,qw,session,match_session\n"
                                  "9,2,Accepted,1,1,2,3,0,0,0,1,1,1\n"
                                  "9,3,Accepted,1,1,2,3,0,0,0,1,1,0\n");
  const auto records = read_loops(loops);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].match, 2u);
}

TEST(LoopTruth, ABadLineOfTheTruthIsNamed) {
  const ScratchFolder folder;
  const auto frames = folder.write("frames.csv", "filename,timestamp_s\na.jpg,10\nb.jpg,noon\n");
  EXPECT_THAT(message_of<InputError>([&] { read_frame_times(frames); }), HasSubstr("frames.csv:3: "));
  const auto pairs = folder.write("pairs.csv", "0,12,1.5,0.3,20\n0,12,1.5\n");
  EXPECT_THAT(message_of<InputError>([&] { read_pairs(pairs); }), HasSubstr("pairs.csv:2: "));
  EXPECT_THROW(read_loop_truth(folder.path()), InputError) << "no reference.tum";
}

}  // namespace
}  // namespace fabloop
