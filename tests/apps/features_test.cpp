// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <set>

#include "tests/apps/program.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// A folder of three images without a calibration.
class FeaturesCommand : public testing::Test {
 protected:
  FeaturesCommand() : images_(scratch_.path() / "images_only"), out_(scratch_.path() / "results" / "out") {
    copy_tiny_sequence(scratch_.path() / "flight", 3);
    fs::copy(scratch_.path() / "flight" / "images", images_, fs::copy_options::recursive);
    fs::create_directory(out_.parent_path());
  }

  ProgramResult run(std::vector<std::string> more) const {
    more.insert(more.begin(), {"features", images_.string(), "--out", out_.string(), "--max-features", "100", "--quiet"});
    return run_fabloop(more);
  }

  test::ScratchFolder scratch_;
  fs::path images_;
  fs::path out_;
};

TEST_F(FeaturesCommand, GivesPicturesATableAndTheSettings) {
  const ProgramResult result = run({"--features", "orb", "fast+brisk", "--pictures", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("| fast+brisk |"), std::string::npos) << result.out;
  const std::set<std::string> names = names_in(out_);
  EXPECT_EQ(names.size(), 7u);  // two pictures and their montage, two settings, two tables
  for (const char* name : {"features.csv", "features.md", "orb.yaml", "fast+brisk.yaml"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const std::string& name : names) {
    if (!name.ends_with(".png")) continue;
    EXPECT_FALSE(cv::imread((out_ / name).string()).empty()) << name;
  }
  EXPECT_NE(bytes_of(out_ / "features.csv").find("orb,3,"), std::string::npos);
  const ProgramResult again = run({"--settings", (out_ / "orb.yaml").string()});
  expect_refused(again, out_.string());
  const fs::path settings = scratch_.path() / "orb.yaml";
  fs::copy(out_ / "orb.yaml", settings);
  EXPECT_EQ(run({"--settings", settings.string(), "--overwrite"}).exit_code, 0);
  EXPECT_EQ(names_in(out_.parent_path()), std::set<std::string>{"out"}) << "a part was left";
}

TEST_F(FeaturesCommand, RefusesWhatMakesNoSense) {
  expect_refused(run({"--features", "fast+akaze"}), "fast+sift");
  expect_refused(run({"--set", "wings=2"}), "wings");
  expect_refused(run({"--set", "star.max_size_px=many"}), "a whole number");
  expect_refused(run({"--settings", scratch_.write("bad.yaml", "features:\n  kin: sift\n").string()}), "bad.yaml:2");
  fs::resize_file(fs::directory_iterator(images_)->path(), 100);
  expect_refused(run({}), images_.string());
  expect_empty(out_.parent_path());
}

TEST_F(FeaturesCommand, RefusesAFolderWithoutImages) {
  fs::remove_all(images_);
  fs::create_directory(images_);
  expect_refused(run({}), images_.string());
  expect_empty(out_.parent_path());
}

TEST(FeaturesUsage, PrintsTheSettingsThatHold) {
  const ProgramResult result =
      run_fabloop({"features", "--print-settings", "--features", "star+sift", "--set", "star.max_size_px=45"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("kind: star+sift"), std::string::npos);
  EXPECT_NE(result.out.find("max_size_px: 45"), std::string::npos);
  EXPECT_EQ(run_fabloop({"features"}).exit_code, 2);
}

}  // namespace
}  // namespace fabloop
