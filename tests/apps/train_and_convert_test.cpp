// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/program.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;
using ::testing::HasSubstr;

/// A sequence, and a small model of it.
class TrainAndConvert : public ::testing::Test {
 protected:
  TrainAndConvert() : sequence_(scratch_.path() / "flight"), model_(scratch_.path() / "a.model") {
    copy_tiny_sequence(sequence_, 5);
    const ProgramResult trained = run_fabloop(train_command());
    EXPECT_EQ(trained.exit_code, 0) << trained.err;
    trained_out_ = trained.out;
  }

  std::vector<std::string> train_command() const {
    return {"train",          sequence_.string(),
            "--out",          model_.string(),
            "--report",       (scratch_.path() / "report.json").string(),
            "--max-features", "100",
            "--words",        "20",
            "--overwrite"};
  }

  test::ScratchFolder scratch_;
  fs::path sequence_, model_;
  std::string trained_out_;
};

TEST_F(TrainAndConvert, ReportsTheModelsHealthAndLeavesNoState) {
  EXPECT_THAT(trained_out_, HasSubstr("! images: 5: few"));
  EXPECT_FALSE(fs::exists(model_.string() + ".part"));
  const auto report = nlohmann::json::parse(std::ifstream(scratch_.path() / "report.json"));
  EXPECT_EQ(report.at("images"), 5);
  EXPECT_EQ(report.at("findings").size(), 10u);
  EXPECT_THAT(bytes_of(model_), HasSubstr("\"mutual_information_nats\""));
}

TEST_F(TrainAndConvert, StartsAnewWhenAnImageHasChangedAndSaysSo) {
  const std::string before = bytes_of(model_);
  fs::create_directory(model_.string() + ".part");
  std::ofstream(model_.string() + ".part/inputs.txt") << "of something else\n";
  const ProgramResult again = run_fabloop(train_command());
  EXPECT_THAT(again.err, HasSubstr("starting anew"));
  EXPECT_TRUE(bytes_of(model_) == before);
}

TEST_F(TrainAndConvert, GoesToOpenFabMapAndBack) {
  const std::string folder = (scratch_.path() / "openfabmap").string(), back = (scratch_.path() / "back.model").string();
  const ProgramResult there = run_fabloop({"convert", model_.string(), "--out", folder});
  ASSERT_EQ(there.exit_code, 0) << there.err;
  const std::vector<std::string> command = {"convert", folder,  "--out",          back,    "--max-features",
                                            "100",     "--set", "root_sift=true", "--set", "clahe_clip_limit=1.5"};
  const ProgramResult returned = run_fabloop(command);
  ASSERT_EQ(returned.exit_code, 0) << returned.err;
  // The arrays, which begin after the header, are the same.
  const std::string a = bytes_of(model_), b = bytes_of(back);
  constexpr std::size_t kTail = 10000;  // most of 20 words of 128 floats
  EXPECT_TRUE(a.substr(a.size() - kTail) == b.substr(b.size() - kTail));
  expect_refused(run_fabloop(command), "exists already");
  expect_refused(run_fabloop({"convert", folder + "/tree.yml", "--out", folder + "/x.model"}), "Vocabulary");
  expect_refused(run_fabloop({"convert", (sequence_ / "frames.csv").string(), "--out", folder + "/x.model"}), "frames.csv");
}

}  // namespace
}  // namespace fabloop
