// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/apps/map_run.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// Less than the first file of a run.
constexpr std::size_t kTinyDisk = 1024;

/// A chain of poses, as text in .g2o form.
std::string chain_g2o(int num_vertices) {
  std::string text;
  for (int i = 0; i < num_vertices; ++i)
    text += "VERTEX_SE3:QUAT " + std::to_string(i) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
  for (int i = 1; i < num_vertices; ++i) {
    text += "EDGE_SE3:QUAT " + std::to_string(i - 1) + " " + std::to_string(i) +
            " 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
  }
  return text;
}

/// An empty folder to write to, and what to write from.
class BadOutput : public testing::Test {
 protected:
  BadOutput() : sequence_(scratch_.path() / "flight"), out_folder_(scratch_.path() / "out") {
    copy_tiny_sequence(sequence_, 5);
    fs::create_directory(out_folder_);
  }

  std::vector<std::string> train_command(const fs::path& out) const {
    return {"train", sequence_.string(), "--out", out.string(), "--max-features", "100", "--words", "20", "--quiet"};
  }
  std::vector<std::string> optimize_command(const fs::path& out) const {
    return {"optimize", scratch_.write("in.g2o", chain_g2o(50)).string(), "--out", out.string(), "--quiet"};
  }

  test::ScratchFolder scratch_;
  fs::path sequence_;
  fs::path out_folder_;
};

TEST_F(BadOutput, AFullDiskLeavesNoRun) {
  const auto command = map_command(sequence_, out_folder_ / "run", kFewFeatures);
  expect_refused(run_fabloop(command, {kTinyDisk}), "run");
  expect_empty(out_folder_);
}

TEST_F(BadOutput, ADiskThatFillsUpAtTheLastFileLeavesNoRun) {
  const auto command = map_command(sequence_, out_folder_ / "run", kFewFeatures);
  ASSERT_EQ(run_fabloop(command).exit_code, 0);
  // The picture is the largest file of so short a run; all the others fit.
  const auto picture_size = static_cast<std::size_t>(fs::file_size(out_folder_ / "run" / "map.png"));
  fs::remove_all(out_folder_ / "run");
  expect_refused(run_fabloop(command, {picture_size - 1}), "map.png");
  expect_empty(out_folder_);
}

TEST_F(BadOutput, AFullDiskLeavesNoModel) {
  expect_refused(run_fabloop(train_command(out_folder_ / "model"), {kTinyDisk}), "model");
  expect_empty(out_folder_);
}

TEST_F(BadOutput, AFullDiskLeavesNoGraph) {
  expect_refused(run_fabloop(optimize_command(out_folder_ / "out.g2o"), {kTinyDisk}), "out.g2o");
  expect_empty(out_folder_);
}

TEST_F(BadOutput, AFullDiskLeavesNoSyntheticFlight) {
  const fs::path out = out_folder_ / "flight";
  expect_refused(run_fabloop({"synth", "--out", out.string(), "--length", "60", "--spacing", "20", "--quiet"}, {kTinyDisk}),
                 "flight");
  expect_empty(out_folder_);
}

TEST_F(BadOutput, AFullDiskKeepsTheRunThatWasToBeReplaced) {
  const fs::path run = out_folder_ / "run";
  fs::create_directory(run);
  scratch_.write("out/run/mine.txt", "mine");
  auto command = map_command(sequence_, run, kFewFeatures);
  command.emplace_back("--overwrite");
  expect_refused(run_fabloop(command, {kTinyDisk}), "run");
  EXPECT_EQ(bytes_of(run / "mine.txt"), "mine");
  fs::remove_all(run);
  expect_empty(out_folder_);
}

TEST_F(BadOutput, AnExistingRunIsNotReplacedUnasked) {
  fs::create_directory(out_folder_ / "run");
  scratch_.write("out/run/mine.txt", "mine");
  expect_refused(run_fabloop(map_command(sequence_, out_folder_ / "run")), (out_folder_ / "run").string());
  EXPECT_EQ(bytes_of(out_folder_ / "run" / "mine.txt"), "mine");
  EXPECT_FALSE(fs::exists(out_folder_ / "run.part"));
}

TEST_F(BadOutput, AnExistingModelIsNotReplacedUnasked) {
  const fs::path model = scratch_.write("out/model", "mine");
  expect_refused(run_fabloop(train_command(model)), model.string());
  EXPECT_EQ(bytes_of(model), "mine");
}

TEST_F(BadOutput, AnExistingGraphIsNotReplacedUnasked) {
  const fs::path graph = scratch_.write("out/out.g2o", "mine");
  expect_refused(run_fabloop(optimize_command(graph)), graph.string());
  EXPECT_EQ(bytes_of(graph), "mine");
}

TEST_F(BadOutput, AnExistingGraphIsReplacedWhenAsked) {
  const fs::path graph = scratch_.write("out/out.g2o", "mine");
  auto command = optimize_command(graph);
  command.emplace_back("--overwrite");
  EXPECT_EQ(run_fabloop(command).exit_code, 0);
  EXPECT_NE(bytes_of(graph), "mine");
}

TEST_F(BadOutput, AMissingFolderForAFileIsRefused) {
  const fs::path missing = out_folder_ / "missing";
  expect_refused(run_fabloop(train_command(missing / "model")), missing.string());
  expect_refused(run_fabloop(optimize_command(missing / "out.g2o")), missing.string());
  expect_empty(out_folder_);
}

}  // namespace
}  // namespace fabloop
