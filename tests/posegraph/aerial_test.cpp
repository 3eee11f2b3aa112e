// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/map_sequence.h"
#include "posegraph/run/run_folder.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// What is promised of real flights.
constexpr std::size_t kMinTrueLoops = 25;
constexpr double kMinErrorRatio = 3.0;

LoopEvaluation judge(const Map& map, const fs::path& flight) {
  const test::ScratchFolder scratch;
  write_loops_csv(scratch.path() / "loops.csv", map);
  return evaluate_loops(read_loops(scratch.path() / "loops.csv"), read_loop_truth(flight));
}

/// Maps a flight with what is there by default, and holds it to the promise.
void expect_right_map(const std::string& name) {
  const fs::path flight = fs::path(FABLOOP_SHARED_DATA_DIR) / "aerial" / name;
  if (!fs::exists(flight)) GTEST_SKIP() << flight << " is not there";
  SequenceOptions sequence_options;
  sequence_options.odometry = flight / "odometry.tum";
  const Sequence sequence = read_sequence(flight, sequence_options);
  const SequenceMap result = map_sequence(sequence, std::nullopt);
  EXPECT_EQ(result.map.graph.vertices.size(), sequence.frames.size());

  const LoopEvaluation judged = judge(result.map, flight);
  EXPECT_EQ(judged.num_false, 0U);
  EXPECT_GE(judged.num_true, kMinTrueLoops);

  const RunErrors errors = run_errors(sequence, result.map);
  ASSERT_TRUE(errors.odometry && errors.final);
  EXPECT_LE(errors.final->translation_m.rmse * kMinErrorRatio, errors.odometry->translation_m.rmse);
}

TEST(Aerial, CaliterraIsMappedWithoutAFalseLoop) { expect_right_map("caliterra"); }

}  // namespace
}  // namespace fabloop
