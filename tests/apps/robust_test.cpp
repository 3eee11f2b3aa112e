// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "frontend/sequence/trajectory_formats.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/similarity_g2o_io.h"
#include "tests/apps/program.h"
#include "tests/posegraph/long_walk.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using namespace testing_support;

/// A walk of three laps that ends with a loop, and one more that is wrong.
class RobustCommand : public testing::Test {
 protected:
  RobustCommand() {
    PoseGraph graph = test::make_long_walk({91, 30, 2, 1});
    Edge wrong = graph.edges.back();
    wrong.from = 10;
    wrong.to = 25;
    graph.edges.push_back(wrong);
    last_ = graph.edges.size() - 1;
    graph_ = scratch_.path() / "walk.g2o";
    write_g2o(graph_, graph);
  }

  /// The last line of the decisions that `optimize` writes.
  std::string last_decision(std::vector<std::string> more) const {
    const auto decisions = scratch_.path() / "decisions.csv";
    std::vector<std::string> command = {"optimize",
                                        graph_.string(),
                                        "--out",
                                        (scratch_.path() / "out.g2o").string(),
                                        "--quiet",
                                        "--overwrite",
                                        "--decisions",
                                        decisions.string(),
                                        "--robust",
                                        "gnc-truncated",
                                        "--robust-probability",
                                        "0.999"};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = run_fabloop(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::istringstream lines(bytes_of(decisions));
    std::string line;
    std::string last;
    while (std::getline(lines, line)) last = line;
    return last;
  }

  test::ScratchFolder scratch_;
  std::filesystem::path graph_;
  std::size_t last_ = 0;
};

TEST_F(RobustCommand, RejectsAFalseLoopUnlessItIsForced) {
  const std::string position = std::to_string(last_);
  EXPECT_TRUE(last_decision({}).ends_with(",Rejected")) << last_decision({});
  EXPECT_TRUE(last_decision({}).starts_with(position + ",10,25,loop,"));
  EXPECT_TRUE(last_decision({"--accept", position}).ends_with(",1,ForcedAccept"));
  EXPECT_TRUE(last_decision({"--reject", std::to_string(last_ - 1) + "," + position}).ends_with(",0,ForcedReject"));
}

TEST_F(RobustCommand, NamesAForcedEdgeThatIsNoLoop) {
  expect_refused(
      run_fabloop({"optimize", graph_.string(), "--out", (scratch_.path() / "out.g2o").string(), "--reject", "0", "--quiet"}),
      "edge 0");
}

TEST_F(RobustCommand, SolvesSimilaritiesAndSaysWhatItDoesNotDoForThem) {
  SimilarityGraph graph = similarity_graph_from(read_g2o(graph_), 0.01);
  graph.vertices[40].world_from_frame.scale = 2.0;
  const auto in = scratch_.path() / "similarities.g2o";
  const auto out = scratch_.path() / "solved.g2o";
  write_g2o(in, graph);
  const std::vector<std::string> command = {"optimize", in.string(), "--out", out.string(), "--quiet", "--overwrite"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = command;
    all.insert(all.end(), more.begin(), more.end());
    return run_fabloop(all);
  };
  expect_refused(with({"--certify"}), in.string());
  expect_refused(with({"--robust", "gnc-truncated"}), in.string());
  expect_refused(with({"--reject", "95"}), in.string());
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(with({"--robust", "dcs"}).exit_code, 0);
  EXPECT_NEAR(read_similarity_g2o(out).vertices[40].world_from_frame.scale, 1.0, 0.1);
}

TEST_F(RobustCommand, KeepsRollAndPitchOnRequest) {
  const auto out = scratch_.path() / "level.g2o";
  const std::vector<std::string> command = {"optimize", graph_.string(), "--out", out.string(), "--quiet", "--freedom", "yaw"};
  EXPECT_EQ(run_fabloop(command).exit_code, 0);
  const PoseGraph before = read_g2o(graph_);
  const PoseGraph after = read_g2o(out);
  double moved = 0.0;
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    const auto up = [&](const PoseGraph& graph) -> Eigen::Vector3d {
      return graph.vertices[v].world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    };
    EXPECT_LT((up(before) - up(after)).norm(), 1e-9);
    moved += (before.vertices[v].world_from_frame.translation - after.vertices[v].world_from_frame.translation).norm();
  }
  EXPECT_GT(moved, 0.1);
  std::vector<std::string> robust = command;
  robust.insert(robust.end(), {"--robust", "gnc-truncated", "--from-poses", "--overwrite"});
  const ProgramResult doubted = run_fabloop(robust);
  EXPECT_EQ(doubted.exit_code, 0) << doubted.err;
  std::vector<std::string> certified = command;
  certified.insert(certified.end(), {"--certify", "--overwrite"});
  expect_refused(run_fabloop(certified), "--freedom");
}

TEST_F(RobustCommand, ConvertTakesGraphsToToroAndBack) {
  const auto toro = scratch_.path() / "walk.graph";
  const auto back = scratch_.path() / "back.g2o";
  EXPECT_EQ(run_fabloop({"convert", graph_.string(), "--out", toro.string(), "--graph-to", "toro"}).exit_code, 0);
  EXPECT_EQ(run_fabloop({"convert", toro.string(), "--out", back.string(), "--graph-to", "g2o"}).exit_code, 0);
  const PoseGraph before = read_g2o(graph_);
  const PoseGraph after = read_g2o(back);
  EXPECT_EQ(after.edges.size(), before.edges.size());
  EXPECT_EQ(test::largest_distance(before, after), 0.0);
  expect_refused(run_fabloop({"convert", toro.string(), "--out", back.string(), "--graph-to", "g2o"}), back.string());
}

TEST_F(RobustCommand, StudyPrintsARowForEachTrial) {
  const ProgramResult result = run_fabloop(
      {"study", graph_.string(), "--shares", "0,0.5", "--back-ends", "gnc-truncated,none", "--patterns", "random,groups"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // A head of two lines; nothing false once, and half of the loops false in two ways; two back ends.
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 2 + 2 * 3) << result.out;
}

TEST_F(RobustCommand, ConvertTakesTrajectoriesThere) {
  const auto tum = scratch_.path() / "walk.tum";
  write_tum(tum, {{1'000'000'000, {}}, {1'500'000'000, test::shift(1, 2, 3)}});
  const auto euroc = scratch_.path() / "walk.csv";
  const auto back = scratch_.path() / "back.tum";
  EXPECT_EQ(run_fabloop({"convert", tum.string(), "--out", euroc.string(), "--trajectory-to", "euroc"}).exit_code, 0);
  EXPECT_EQ(run_fabloop({"convert", euroc.string(), "--out", back.string(), "--trajectory-to", "tum"}).exit_code, 0);
  EXPECT_EQ(bytes_of(back), bytes_of(tum));
  expect_refused(run_fabloop({"convert", graph_.string(), "--out", (scratch_.path() / "x").string(), "--trajectory-to", "tum"}),
                 graph_.string());
}

}  // namespace
}  // namespace fabloop
