// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/run_folder.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "frontend/error.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/g2o/g2o_io.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/tiny_map.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing_support::read_tiny_sequence;
using testing_support::tiny_map_options;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A few frames of the tiny flight and what they were mapped to.
struct ShortRun {
  ShortRun() {
    sequence.frames.resize(5);
    result = map_sequence(sequence, std::nullopt, options);
  }
  Sequence sequence = read_tiny_sequence();
  MapSequenceOptions options = tiny_map_options();
  SequenceMap result;
};

/// A ledger of two hypotheses of one query: one accepted, one not.
Map map_with_two_hypotheses() {
  LoopEvent event;
  event.query = 31;
  event.p_new = 0.125;
  HypothesisOutcome accepted;
  accepted.match = 4;
  accepted.probability = 0.75;
  accepted.verification.verdict = Verdict::Accepted;
  accepted.verification.num_matches = 80;
  accepted.verification.num_inliers = 60;
  accepted.verification.has_scale = true;
  accepted.verification.match_from_query = {rotation_from_vector({0.1, -0.2, 0.3}), {1.5, -2.25, 1.0 / 3.0}};
  HypothesisOutcome rejected;
  rejected.match = 9;
  rejected.verification.verdict = Verdict::TooFewInliers;
  event.hypotheses = {accepted, rejected};
  Map map;
  map.events = {event};
  return map;
}

TEST(LoopsCsv, BeginsWithTheColumnsOfTheContract) {
  const test::ScratchFolder scratch;
  write_loops_csv(scratch.path() / "loops.csv", map_with_two_hypotheses());
  const std::string text = text_of(scratch.path() / "loops.csv");
  EXPECT_TRUE(text.starts_with("query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw,")) << text;
  EXPECT_NE(text.find("\n31,4,0.75,Accepted,80,60,1,1.5,-2.25,"), std::string::npos) << text;
  EXPECT_NE(text.find("\n31,9,0,TooFewInliers,0,0,0,"), std::string::npos) << text;
}

TEST(LoopsCsv, IsReadBackExactly) {
  const test::ScratchFolder scratch;
  const Map map = map_with_two_hypotheses();
  write_loops_csv(scratch.path() / "loops.csv", map);
  const auto records = read_loops(scratch.path() / "loops.csv");
  ASSERT_EQ(records.size(), 2U);
  const Pose& written = map.events[0].hypotheses[0].verification.match_from_query;
  EXPECT_EQ(records[0].query, 31U);
  EXPECT_EQ(records[0].match, 4U);
  EXPECT_TRUE(records[0].accepted());
  EXPECT_TRUE(records[0].has_scale);
  ASSERT_TRUE(records[0].match_from_query.has_value());
  EXPECT_EQ(records[0].match_from_query->translation, written.translation);
  EXPECT_LT(records[0].match_from_query->rotation.angularDistance(written.rotation), 1e-12);
  EXPECT_EQ(records[1].verdict, "TooFewInliers");
  EXPECT_FALSE(records[1].accepted());
}

TEST(RunFolder, IsCompleteAndReadable) {
  const test::ScratchFolder scratch;
  const ShortRun run;
  const fs::path folder = scratch.path() / "run";
  write_run_folder(folder, run.sequence, run.result, run.options);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  for (const char* name : {"summary.json", "trajectory.tum", "trajectory_online.tum", "trajectory_odometry.tum", "graph.g2o",
                           "loops.csv", "inliers.npy", "points.ply", "map.png"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
  EXPECT_FALSE(fs::exists(scratch.path() / "run.part"));
  const Map& map = run.result.map;
  for (const char* name : {"trajectory.tum", "trajectory_online.tum", "trajectory_odometry.tum"}) {
    const Trajectory trajectory = read_tum(folder / name);
    ASSERT_EQ(trajectory.size(), map.graph.vertices.size()) << name;
    for (std::size_t i = 0; i < trajectory.size(); ++i) EXPECT_EQ(trajectory[i].time_ns, run.sequence.frames[i].time_ns) << name;
  }
  const PoseGraph graph = read_g2o(folder / "graph.g2o");
  EXPECT_EQ(graph.vertices.size(), map.graph.vertices.size());
  EXPECT_EQ(graph.edges.size(), map.graph.edges.size());

  const auto summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  const auto& frames = summary.at("frames");
  EXPECT_EQ(frames.at("images").get<std::size_t>(), run.sequence.frames.size());
  EXPECT_EQ(frames.at("images").get<int>(),
            frames.at("mapped").get<int>() + frames.at("damaged").get<int>() + frames.at("without_odometry").get<int>());
  EXPECT_EQ(summary.at("seed"), run.options.seed);
  for (const auto& [stage, timing] : summary.at("timings").items()) {
    for (const char* figure : {"p50_ms", "p99_ms", "total_s"}) EXPECT_TRUE(timing.contains(figure)) << stage << " " << figure;
  }
}

TEST(RunFolder, ThatExistsIsRefusedUnlessItIsToBeReplaced) {
  const test::ScratchFolder scratch;
  const ShortRun run;
  const fs::path folder = scratch.path() / "run";
  fs::create_directory(folder);
  scratch.write("run/mine.txt", "mine");
  const std::string message =
      test::message_of<InputError>([&] { write_run_folder(folder, run.sequence, run.result, run.options); });
  EXPECT_NE(message.find(folder.string()), std::string::npos) << message;
  EXPECT_EQ(text_of(folder / "mine.txt"), "mine");
  write_run_folder(folder, run.sequence, run.result, run.options, OutputFolder::IfExists::Replace);
  EXPECT_FALSE(fs::exists(folder / "mine.txt"));
  EXPECT_TRUE(fs::exists(folder / "summary.json"));
}

TEST(RunFolder, ThatFailsHalfWayLeavesNothing) {
  const test::ScratchFolder scratch;
  ShortRun run;
  run.result.map.graph.edges.front().to = 99;  // the graph is written after the trajectories
  EXPECT_ANY_THROW(write_run_folder(scratch.path() / "run", run.sequence, run.result, run.options));
  EXPECT_TRUE(fs::is_empty(scratch.path()));
}

TEST(PointsPly, HoldsAsManyPointsAsItsHeadSays) {
  const test::ScratchFolder scratch;
  const ShortRun run;
  write_points_ply(scratch.path() / "points.ply", run.result.map);
  std::size_t num_points = 0;
  for (const View& view : run.result.map.views) num_points += count_points(view);
  EXPECT_GT(num_points, 0U);
  const std::string bytes = text_of(scratch.path() / "points.ply");
  EXPECT_NE(bytes.find("element vertex " + std::to_string(num_points) + "\n"), std::string::npos);
  const std::string head_end = "end_header\n";
  constexpr std::size_t kBytesPerPoint = 3 * 4 + 3;
  EXPECT_EQ(bytes.size() - bytes.find(head_end) - head_end.size(), kBytesPerPoint * num_points);
}

}  // namespace
}  // namespace fabloop
