// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "frontend/error.h"
#include "frontend/folder_lock.h"
#include "posegraph/map_sequence.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Experiments over the tiny flight, with few features.
class LabRun : public testing::Test {
 protected:
  LabDescription describe(const std::string& more) {
    const fs::path sequence = testing_support::tiny_sequence();
    const std::string data = "data: {sequences: [{folder: " + sequence.filename().string() + ", height_m: 20}]}\n";
    return read_lab_description(
        folder_.write("lab.yaml", data + "features: {max_features: 200}\nbootstrap: {resamples: 20}\n" + more));
  }

  LabRunReport run(const LabDescription& description, const std::string& out, int num_jobs = 1) {
    return run_lab(description, folder_.path() / out,
                   {.data_root = testing_support::tiny_sequence().parent_path(), .num_jobs = num_jobs});
  }

  /// Every file below a folder.
  std::map<std::string, std::string> files_of(const std::string& out) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / out)) {
      if (!entry.is_regular_file()) continue;
      std::ostringstream bytes;
      bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      files[fs::relative(entry.path(), folder_.path() / out).string()] = bytes.str();
    }
    return files;
  }

  nlohmann::json rows_of(const std::string& out) const {
    return nlohmann::json::parse(std::ifstream(folder_.path() / out / "results.json")).at("rows");
  }

  test::ScratchFolder folder_;
};

constexpr const char* kBaselines = R"(
sweep: {blurred_frames: [0, 0.5]}
methods: [fabmap, tf-idf]
stages: [appearance]
)";

TEST_F(LabRun, ARunThatIsResumedGivesTheSameBytesWithAnyNumberOfJobs) {
  const LabDescription lab = describe(kBaselines);
  EXPECT_EQ(run(lab, "whole").num_there, 0u);
  const auto whole = files_of("whole");
  ASSERT_TRUE(whole.contains("table.md"));
  ASSERT_TRUE(whole.contains("results.csv"));
  ASSERT_TRUE(whole.contains("precision_recall_2.png"));
  EXPECT_EQ(whole.at("description.yaml"), files_of(".").at("lab.yaml"));
  // Killed before the second cell was done: its file is not there, its scratch is.
  fs::copy(folder_.path() / "whole", folder_.path() / "killed", fs::copy_options::recursive);
  const auto last = std::find_if(whole.rbegin(), whole.rend(), [](const auto& file) { return file.first.starts_with("cells/"); });
  ASSERT_NE(last, whole.rend());
  fs::remove(folder_.path() / "killed" / last->first);
  fs::create_directory(folder_.path() / "killed" / (last->first.substr(0, last->first.size() - 5) + ".scratch"));
  const LabRunReport resumed = run(lab, "killed", 2);
  EXPECT_EQ(resumed.num_cells, 2u);
  EXPECT_EQ(resumed.num_there, 1u);
  EXPECT_EQ(files_of("killed"), whole);
  EXPECT_EQ(run(lab, "killed").num_there, 2u);
  EXPECT_EQ(files_of("killed"), whole);
}

TEST_F(LabRun, AChangedDescriptionIsNoticed) {
  run(describe("methods: [seqslam]\nstages: [appearance]\n"), "out");
  const LabRunReport report = run(describe("set: {window: 8}\nmethods: [seqslam]\nstages: [appearance]\n"), "out");
  EXPECT_EQ(report.num_there, 0u);
  EXPECT_EQ(report.num_stale, 1u);
}

TEST_F(LabRun, PicturesOfAnEarlierDescriptionAreRemovedAndTheTextIsTheOneThatWasRead) {
  run(describe("sweep: {top: [2, 5]}\nmethods: [tf-idf]\nstages: [appearance]\n"), "out");
  const auto before = files_of("out");
  ASSERT_TRUE(before.contains("precision_recall_2.png"));
  ASSERT_TRUE(std::any_of(before.begin(), before.end(), [](const auto& f) { return f.first.starts_with("false_share_"); }));
  const LabDescription lab = describe("methods: [tf-idf]\nstages: [appearance]\n");
  const std::string text = files_of(".").at("lab.yaml");
  folder_.write("out/mine.png", "of the user's own");
  folder_.write("lab.yaml", "title: changed in the meantime\n");
  run(lab, "out");
  const auto after = files_of("out");
  EXPECT_TRUE(after.contains("precision_recall_1.png"));
  EXPECT_FALSE(after.contains("precision_recall_2.png"));
  EXPECT_TRUE(std::none_of(after.begin(), after.end(), [](const auto& f) { return f.first.starts_with("false_share_"); }));
  EXPECT_TRUE(after.contains("mine.png"));
  EXPECT_EQ(after.at("description.yaml"), text);
}

TEST_F(LabRun, AFolderOfSomethingElseIsLeftAlone) {
  fs::create_directory(folder_.path() / "thesis");
  folder_.write("thesis/chapter1.tex", "dear reader");
  EXPECT_THAT(test::message_of<InputError>([&] { run(describe(kBaselines), "thesis"); }),
              HasSubstr("thesis: holds something else"));
  EXPECT_EQ(files_of("thesis").size(), 1u);
}

TEST_F(LabRun, AFolderInWhichAnotherRunIsAtWorkIsLeftAlone) {
  fs::create_directories(folder_.path() / "busy" / "cells");
  const FolderLock other(folder_.path() / "busy");
  EXPECT_THAT(test::message_of<InputError>([&] { run(describe(kBaselines), "busy"); }),
              HasSubstr("busy: another run is at work in this folder"));
  EXPECT_TRUE(files_of("busy").empty());
}

TEST_F(LabRun, AFreshRunMakesAllCellsAnew) {
  const LabDescription lab = describe("methods: [seqslam]\nstages: [appearance]\n");
  run(lab, "out");
  const auto before = files_of("out");
  folder_.write("out/cells/0123456789abcdef.json", "of another description");
  folder_.write("out/mine.txt", "of the user's own");
  const LabRunReport report = run_lab(
      lab, folder_.path() / "out",
      {.data_root = testing_support::tiny_sequence().parent_path(), .num_jobs = 1, .if_found = WorkState::IfFound::Discard});
  EXPECT_EQ(report.num_there, 0u);
  EXPECT_EQ(report.num_stale, 0u);
  auto after = files_of("out");
  EXPECT_EQ(after.erase("mine.txt"), 1u);
  EXPECT_EQ(after, before);
}

TEST_F(LabRun, TheScoresOfAFileAreJudgedAsTheMethodThatMadeThem) {
  run(describe("methods: [tf-idf]\nstages: [appearance]\nset: {top: 1000}\n"), "built-in");
  // Its scores, from the cell's file, as any other method would give them.
  const auto cells = files_of("built-in");
  const auto cell = std::find_if(cells.begin(), cells.end(), [](const auto& file) { return file.first.starts_with("cells/"); });
  std::ostringstream scores;
  scores << "query,match,score\n";
  const auto json = nlohmann::json::parse(cell->second);
  for (const auto& row : json.at("methods").at(0).at("hypotheses"))
    scores << row.at(0) << ',' << row.at(1) << ',' << row.at(3) << '\n';
  folder_.write("mine.csv", scores.str());
  run(describe("methods: [{name: mine, scores: mine.csv}]\nstages: [appearance]\nset: {top: 1000}\n"), "file");
  nlohmann::json expected = rows_of("built-in"), found = rows_of("file");
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(found[i].at("label"), "scores of mine.csv");
    for (auto* rows : {&expected, &found}) {
      (*rows)[i].erase("method");
      (*rows)[i].erase("label");
    }
    EXPECT_EQ(found[i], expected[i]);
  }
}

TEST_F(LabRun, TheStagesOfFabMapAreThoseOfTheMapper) {
  const LabDescription lab = describe(R"(
set: {top: 3, grouped_false_loops: 0.5}
methods: [fabmap]
stages: [appearance, geometry, back end]
back_ends: [map, none, gnc-truncated]
)");
  run(lab, "out");
  const Sequence sequence =
      read_sequence(testing_support::tiny_sequence(), {.odometry = testing_support::tiny_sequence() / "odometry.tum"});
  MapSequenceOptions options;
  options.features = lab.features;
  options.mapper.loops.hypotheses.max_hypotheses = 3;
  options.mapper.max_loop_surprise = 1.0;
  const SequenceMap mapped = map_sequence(sequence, std::nullopt, options);
  std::size_t num_hypotheses = 0, num_loops = 0;
  for (const LoopEvent& event : mapped.map.events) {
    num_hypotheses += event.hypotheses.size();
    num_loops += event.loops.size();
  }
  ASSERT_GT(num_loops, 2u);
  const nlohmann::json rows = rows_of("out");
  const auto total = [](const nlohmann::json& counts) {
    return counts.at("true").get<std::size_t>() + counts.at("false").get<std::size_t>() +
           counts.value("unjudged", std::size_t{0});
  };
  EXPECT_EQ(rows[0].at("stage"), "appearance");
  EXPECT_EQ(total(rows[0].at("passed")), num_hypotheses);
  EXPECT_EQ(rows[1].at("stage"), "geometry");
  EXPECT_EQ(total(rows[1].at("passed")), num_loops);
  // Half of all loops are injected ones, so as many as the map's own; without a back end all are kept.
  EXPECT_EQ(rows[3].at("stage"), "back end: none");
  EXPECT_EQ(total(rows[3].at("passed")), 2 * num_loops);
  EXPECT_GE(rows[3].at("passed").at("false").get<std::size_t>(), num_loops - 2) << "a false loop that is right by accident";
  EXPECT_LT(rows[4].at("passed").at("false"), rows[3].at("passed").at("false"));
  EXPECT_TRUE(rows[4].at("ate_m").is_number());
}

TEST_F(LabRun, PairsAcrossAreFalseAtEveryStageAndNoBackEndSeesThem) {
  // The earlier flight shows the same place, so that its pairs pass geometry: called false, they must be counted at each stage.
  fs::copy(testing_support::tiny_sequence(), folder_.path() / "earlier", fs::copy_options::recursive);
  const fs::path file = folder_.write("across.yaml", "data: {sequences: [{folder: " + testing_support::tiny_sequence().string() +
                                                         ", height_m: 20, earlier: earlier}]}\n" + R"(
set: {top: 3}
features: {max_features: 200}
bootstrap: {resamples: 0}
methods: [fabmap, tf-idf]
stages: [appearance, geometry, back end]
back_ends: [map]
)");
  run_lab(read_lab_description(file), folder_.path() / "out", {.num_jobs = 1});
  const nlohmann::json rows = rows_of("out");
  const auto passed = [&](std::size_t row, const char* what) { return rows.at(row).at("passed").at(what).get<std::size_t>(); };
  const std::size_t num_frames = read_sequence(testing_support::tiny_sequence()).frames.size();
  for (const std::size_t method : {0u, 3u}) {
    EXPECT_EQ(rows[method].at("stage"), "appearance");
    EXPECT_EQ(rows[method].at("queries"), num_frames);
    // As many places of the earlier flight as were asked for, at each frame.
    EXPECT_GE(passed(method, "false"), 3 * num_frames);
    EXPECT_GT(passed(method, "true"), 0u);
    EXPECT_GT(passed(method + 1, "false"), num_frames) << "geometry proves that the place is the same";
    EXPECT_EQ(passed(method + 2, "false"), passed(method + 1, "false"));
    EXPECT_GT(passed(method + 2, "true"), 0u);
  }
  EXPECT_THAT(rows[0].at("recipe").get<std::string>(), HasSubstr("places of the earlier flight are false"));
}

TEST_F(LabRun, ASyntheticWorldIsMadeAndItsTroublesAreMet) {
  const fs::path file = folder_.write("world.yaml", R"(
data: {synthetic: {length_m: 100, spacing_m: 5, mean_height_m: 20, height_spread_m: 2, texture_m_per_px: 0.25, height_m_per_px: 0.4, camera_scale: 0.25, tile_m: 20}}
set: {aliasing: 0.5, dropped_frames: 0.25, odometry_slips: 0.1}
features: {max_features: 100}
bootstrap: {resamples: 0}
methods: [vlad, naive-bayes]
stages: [appearance]
)");
  run_lab(read_lab_description(file), folder_.path() / "out", {.num_jobs = 1});
  const auto files = files_of("out");
  const auto cell = std::find_if(files.begin(), files.end(), [](const auto& f) { return f.first.starts_with("cells/"); });
  const auto json = nlohmann::json::parse(cell->second);
  // Tiles are whole: half of them, to the nearest one.
  EXPECT_NEAR(json.at("aliased_share").get<double>(), 0.5, 0.1);
  const auto& trouble = json.at("trouble");
  const std::size_t dropped = trouble.at("dropped"), frames = trouble.at("frames"), steps = trouble.at("steps");
  EXPECT_EQ(dropped, static_cast<std::size_t>(std::lround(0.25 * static_cast<double>(dropped + frames))));
  EXPECT_EQ(json.at("frames"), frames);
  EXPECT_EQ(steps, frames - 1);
  EXPECT_EQ(trouble.at("slips"), static_cast<std::size_t>(std::lround(0.1 * static_cast<double>(steps))));
  EXPECT_EQ(json.at("methods").size(), 2u);
  for (const auto& [name, text] : files) EXPECT_EQ(name.find("scratch"), std::string::npos) << name;
}

}  // namespace
}  // namespace fabloop
