// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>

#include "tests/apps/map_run.h"
#include "tests/apps/same_runs.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/http_client.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop::testing_support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class LiveRun : public ::testing::Test {
 protected:
  test::ScratchFolder scratch_;
  fs::path run_ = scratch_.path() / "run";
};

/// The port of a line `live view: http://127.0.0.1:PORT/`; 0 of others.
int port_in(const std::string& line) {
  const std::string begin = "live view: http://127.0.0.1:";
  return line.starts_with(begin) ? std::stoi(line.substr(begin.size())) : 0;
}

/// What a page would have at the run's end.
struct SeenPage {
  std::string page;
  std::set<std::string> states, stages;
  std::size_t most_placed = 0;
  nlohmann::json last;
  std::string report;
};

/// Looks at a run as its page does, until it has ended.
SeenPage watch(int port) {
  SeenPage seen;
  seen.page = ask_http(port, "GET", "/").body;
  for (;;) {
    const HttpAnswer answer = ask_http(port, "GET", "/live.json?since=0&page=test");
    if (answer.status != 200) return seen;
    seen.last = nlohmann::json::parse(answer.body);
    seen.states.insert(seen.last.at("state"));
    for (const auto& stage : seen.last.at("stages")) seen.stages.insert(stage.at("name"));
    seen.most_placed = std::max(seen.most_placed, seen.last.at("placed").size() / 4);
    if (seen.last.at("state") != "running") break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  seen.report = ask_http(port, "GET", "/report.html?page=test").body;
  return seen;
}

/// Runs the program with a page open.
ProgramResult run_watched(const std::vector<std::string>& command, SeenPage& seen) {
  ProgramLimits limits;
  limits.on_line = [&](const std::string& line) {
    if (const int port = port_in(line); port > 0) seen = watch(port);
  };
  return run_fabloop(command, limits);
}

TEST_F(LiveRun, AnExperimentShowsHowManyOfItsCellsAreDone) {
  const fs::path description =
      scratch_.write("small.yaml", "title: Small\ndata: {sequences: [{folder: " + tiny_sequence().filename().string() +
                                       "}]}\nmethods: [seqslam]\nstages: [appearance]\nfeatures: {max_features: 100}\n");
  SeenPage seen;
  const ProgramResult result = run_watched({"lab", description.string(), "--out", run_.string(), "--data",
                                            tiny_sequence().parent_path().string(), "--quiet", "--live"},
                                           seen);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(data_of(seen.page).at("live").at("shows"), "progress");
  EXPECT_EQ(seen.states.count("running"), 1u);
  ASSERT_EQ(seen.last.at("state"), "ended");
  EXPECT_EQ(seen.last.at("stages").back().at("name"), "cells");
  EXPECT_EQ(seen.last.at("stages").back().at("done"), 1);
  EXPECT_FALSE(seen.last.at("has_report").get<bool>());
  EXPECT_TRUE(fs::exists(run_ / "table.md"));
}

TEST_F(LiveRun, IsServedUntilItsReportIsThereAndHasTheBytesOfOneThatIsNot) {
  const fs::path alone = scratch_.path() / "alone";
  ASSERT_EQ(run_fabloop(map_command(tiny_sequence(), alone, {"--max-features", "200"})).exit_code, 0);
  SeenPage seen;
  const ProgramResult result = run_watched(map_command(tiny_sequence(), run_, {"--max-features", "200", "--live"}), seen);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("live view: http://127.0.0.1:"));
  const auto data = data_of(seen.page);
  EXPECT_EQ(data.at("live").at("run"), seen.last.at("run"));
  EXPECT_EQ(data.at("live").at("folder"), run_.string());
  EXPECT_EQ(seen.states, (std::set<std::string>{"running", "ended"}));
  EXPECT_TRUE(seen.stages.contains("features") && seen.stages.contains("mapping") && seen.stages.contains("report"));
  EXPECT_TRUE(seen.report == bytes_of(run_ / "report.html"));
  const auto report = data_of(seen.report);
  EXPECT_EQ(seen.last.at("placed").size(), report.at("map").at("final").size());
  EXPECT_EQ(seen.last.at("loops").size() / 5, report.at("ledger").at("query").size());
  EXPECT_EQ(seen.last.at("counts").at("accepted"), report.at("summary").at("loops").at("accepted"));
  expect_same_runs(alone, run_);
}

TEST_F(LiveRun, FromImagesAloneIsServedAndTheSame) {
  const fs::path flight = scratch_.path() / "flight", alone = scratch_.path() / "alone";
  copy_tiny_sequence(flight, 10);  // more would only take longer
  ASSERT_EQ(run_fabloop(images_command(flight, alone, {"--quiet"})).exit_code, 0);
  SeenPage seen;
  const ProgramResult result = run_watched(images_command(flight, run_, {"--quiet", "--live"}), seen);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(seen.last.at("state"), "ended");
  EXPECT_TRUE(seen.stages.contains("placing") && seen.stages.contains("adjust"));
  EXPECT_EQ(seen.most_placed, data_of(seen.report).at("map").at("final").size() / 4);
  expect_same_runs(alone, run_);
}

TEST_F(LiveRun, ThatFailsSaysWhyAndEnds) {
  const fs::path flight = scratch_.path() / "flight";
  copy_tiny_sequence(flight, 10);
  // The last image, so that the page is open before it comes.
  std::ofstream(flight / "images" / *names_in(flight / "images").rbegin()) << "no image";
  SeenPage seen;
  const ProgramResult result = run_watched(map_command(flight, run_, {"--max-features", "200", "--strict", "--live"}), seen);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(seen.last.at("state"), "failed");
  EXPECT_THAT(result.err, HasSubstr(seen.last.at("why").get<std::string>()));
}

TEST_F(LiveRun, APortInUseIsRefusedBeforeTheWork) {
  const ListeningSocket other;
  const std::string port = std::to_string(other.port());
  expect_refused(run_fabloop(map_command("no such flight", run_, {"--live", port})), "--live " + port + ": the port is in use");
  expect_refused(run_fabloop({"map", "no such flight", "--out", run_.string(), "--live", port}), "the port is in use");
  expect_empty(scratch_.path());
}

TEST_F(LiveRun, WhatIsNoPortIsWrongUsage) {
  for (const char* port : {"flight", "65536"}) {
    const ProgramResult result = run_fabloop(map_command(tiny_sequence(), run_, {std::string("--live=") + port}));
    EXPECT_EQ(result.exit_code, 2) << port;
    EXPECT_THAT(result.err + result.out, HasSubstr("is no port")) << port;
  }
  expect_empty(scratch_.path());
}

}  // namespace
}  // namespace fabloop::testing_support
