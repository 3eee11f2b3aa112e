// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/apps/map_run.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop::testing_support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class MapFromImages : public ::testing::Test {
 protected:
  MapFromImages() { copy_tiny_sequence(flight_, kNumFrames); }

  static constexpr std::size_t kNumFrames = 10;  // more would only take longer
  test::ScratchFolder scratch_;
  fs::path flight_ = scratch_.path() / "flight", run_ = scratch_.path() / "run";
};

TEST_F(MapFromImages, KilledItGoesOnToTheSameFiles) {
  const fs::path whole = scratch_.path() / "whole";
  ASSERT_EQ(run_fabloop(images_command(flight_, whole, {"--no-report", "--quiet"})).exit_code, 0);
  for (const char* file : {"view-00003", "pairs-00000"}) {
    const ProgramResult killed =
        run_fabloop(images_command(flight_, run_, {"--no-report"}), {.kill_when_exists = run_.string() + ".part/" + file});
    ASSERT_EQ(killed.exit_code, -1) << killed.out << killed.err;
    EXPECT_FALSE(fs::exists(run_));
  }
  const ProgramResult resumed = run_fabloop(images_command(flight_, run_, {"--no-report"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("run.part: 10 of 10 images need not be read again"));
  for (const char* file : {"trajectory.tum", "points.ply", "graph.g2o", "loops.csv", "inliers.npy", "colmap/points3D.txt"}) {
    EXPECT_TRUE(bytes_of(run_ / file) == bytes_of(whole / file)) << file;
  }
  EXPECT_FALSE(fs::exists(run_.string() + ".part"));
}

TEST_F(MapFromImages, HasAReportInTheReferencesUnitAndSaysWhatLoopsAreWorth) {
  const fs::path flight = tiny_sequence();  // the whole, which comes back to its start
  const ProgramResult result = run_fabloop(images_command(flight, run_, {"--quiet", "--without-loops"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto data = data_of(bytes_of(run_ / "report.html"));
  EXPECT_EQ(data.at("map").at("unit"), "m");
  EXPECT_EQ(data.at("map").at("final").size(), 4 * data.at("frames").size());
  const std::vector<int> counts = data.at("inliers").at("counts");
  EXPECT_EQ(counts.size(), data.at("ledger").at("query").size());
  EXPECT_GT(std::count_if(counts.begin(), counts.end(), [](int count) { return count > 0; }), 0);
  EXPECT_FALSE(data.at("ledger").contains("p_new"));
  std::vector<std::string> errors;
  for (const auto& error : data.at("truth").at("errors")) errors.push_back(error.at("name"));
  EXPECT_EQ(errors, (std::vector<std::string>{"odometry", "final"}));
  const ProgramResult judged = run_fabloop({"evaluate", run_.string(), "--truth", flight.string(), "--sim3", "--json"});
  ASSERT_EQ(judged.exit_code, 0) << judged.err;
  const ProgramResult by_poses =
      run_fabloop({"evaluate", run_.string(), "--truth", (flight / "reference.tum").string(), "--yaw", "--false-radius", "100"});
  ASSERT_EQ(by_poses.exit_code, 0) << by_poses.err;
  EXPECT_THAT(by_poses.out, HasSubstr("aligned by yaw"));
  EXPECT_THAT(by_poses.out, HasSubstr("a pair is false beyond 100 m"));
  expect_refused(run_fabloop({"evaluate", run_.string(), "--truth", (flight / "reference.tum").string(), "--false-radius", "5"}),
                 "false radius");
  const auto figures = nlohmann::json::parse(judged.out);
  const auto ate = [&](const char* name) { return figures.at("trajectories").at(name).at("ate_m").at("rmse").get<double>(); };
  EXPECT_DOUBLE_EQ(figures.at("error_left").get<double>(), ate("trajectory.tum") / ate("trajectory_odometry.tum"));
  EXPECT_TRUE(figures.at("without_stages").empty());
  for (const auto* stages : {&figures.at("stages").at("stages"), &data.at("truth").at("evaluation").at("stages")}) {
    ASSERT_FALSE(stages->empty());
    for (const auto& stage : *stages) {
      EXPECT_TRUE(stage.at("calibration").is_null()) << "no probability is claimed of any pair";
      EXPECT_TRUE(stage.at("expected_calibration_error").is_null());
      EXPECT_TRUE(stage.at("curve").is_null());
      EXPECT_FALSE(stage.at("precision").is_null());
    }
  }
}

}  // namespace
}  // namespace fabloop::testing_support
