// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/apps/map_run.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// A sequence, a small ORB model of it, and an empty folder to write to.
class BadModel : public testing::Test {
 protected:
  BadModel()
      : sequence_(scratch_.path() / "flight"), model_(scratch_.path() / "orb.model"), out_folder_(scratch_.path() / "out") {
    copy_tiny_sequence(sequence_, 5);
    fs::create_directory(out_folder_);
    const ProgramResult trained = run_fabloop({"train", sequence_.string(), "--out", model_.string(), "--features", "orb",
                                               "--max-features", "150", "--words", "20", "--quiet"});
    EXPECT_EQ(trained.exit_code, 0) << trained.err;
  }

  void expect_map_refused(const std::string& culprit, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--model", model_.string()});
    expect_refused(run_fabloop(map_command(sequence_, out_folder_ / "run", more)), culprit);
    expect_empty(out_folder_);
  }

  test::ScratchFolder scratch_;
  fs::path sequence_;
  fs::path model_;
  fs::path out_folder_;
};

TEST_F(BadModel, OfAnotherFeatureKindIsRefused) { expect_map_refused("sift", {"--features", "sift"}); }

TEST_F(BadModel, WithAnotherLimitOfFeaturesIsRefused) { expect_map_refused("200", {"--max-features", "200"}); }

TEST_F(BadModel, WhoseFeaturesAreAskedForIsTaken) {
  const auto command =
      map_command(sequence_, out_folder_ / "run", {"--model", model_.string(), "--features", "orb", "--max-features", "150"});
  EXPECT_EQ(run_fabloop(command).exit_code, 0);
}

TEST_F(BadModel, ThatIsTruncatedIsRefused) {
  fs::resize_file(model_, fs::file_size(model_) / 2);
  expect_map_refused(model_.string());
}

TEST_F(BadModel, ThatIsSomethingElseIsRefused) {
  scratch_.write("orb.model", "this is no model, but it is as long as the head of one");
  expect_map_refused(model_.string());
}

TEST_F(BadModel, ThatIsMissingIsRefused) {
  fs::remove(model_);
  expect_map_refused(model_.string());
}

/// What `optimize` says to a graph.
void expect_graph_refused(const std::string& text, const std::string& culprit) {
  const test::ScratchFolder scratch;
  const fs::path in = scratch.write("in.g2o", text);
  fs::create_directory(scratch.path() / "out");
  expect_refused(run_fabloop({"optimize", in.string(), "--out", (scratch.path() / "out" / "out.g2o").string(), "--quiet"}),
                 culprit);
  expect_empty(scratch.path() / "out");
}

TEST(BadGraph, ABrokenLineIsRefused) {
  expect_graph_refused("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 zero 0 1\n", "in.g2o:2");
}

TEST(BadGraph, ALineThatEndsEarlyIsRefused) {
  expect_graph_refused("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\nEDGE_SE3:QUAT 0 1 1 0 0\n", "in.g2o:3");
}

TEST(BadGraph, AnEmptyFileIsRefused) { expect_graph_refused("", "in.g2o"); }

TEST(BadGraph, AMissingFileIsRefused) {
  const test::ScratchFolder scratch;
  const fs::path in = scratch.path() / "in.g2o";
  expect_refused(run_fabloop({"optimize", in.string(), "--out", (scratch.path() / "out.g2o").string(), "--quiet"}), in.string());
  expect_empty(scratch.path());
}

TEST(BadRun, EvaluateRefusesAFolderThatIsNoRun) {
  const test::ScratchFolder scratch;
  expect_refused(run_fabloop({"evaluate", scratch.path().string(), "--truth", tiny_sequence().string()}),
                 scratch.path().string());
}

TEST(BadRun, EvaluateRefusesAMissingReference) {
  const test::ScratchFolder scratch;
  const fs::path truth = scratch.path() / "truth.tum";
  expect_refused(run_fabloop({"evaluate", scratch.path().string(), "--truth", truth.string()}), truth.string());
}

}  // namespace
}  // namespace fabloop
