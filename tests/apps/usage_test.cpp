// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/apps/program.h"

namespace fabloop {
namespace {

using testing_support::ProgramResult;
using testing_support::run_fabloop;

void expect_wrong_usage(const std::vector<std::string>& arguments) {
  const ProgramResult result = run_fabloop(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
  EXPECT_FALSE(result.err.empty());
}

TEST(Usage, HelpOfEveryCommandSucceeds) {
  EXPECT_EQ(run_fabloop({"--help"}).exit_code, 0);
  for (const char* command : {"demo", "synth", "features", "train", "convert", "recognize", "verify", "study", "survey", "map",
                              "optimize", "evaluate"}) {
    const ProgramResult result = run_fabloop({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command << result.err;
    EXPECT_NE(result.out.find("--"), std::string::npos) << command;
    EXPECT_TRUE(result.err.empty()) << command << result.err;
  }
}

TEST(Usage, NoCommandIsWrong) { expect_wrong_usage({}); }
TEST(Usage, AnUnknownCommandIsWrong) { expect_wrong_usage({"fly"}); }
TEST(Usage, AnUnknownOptionIsWrong) { expect_wrong_usage({"map", "folder", "--out", "run", "--wings", "2"}); }
TEST(Usage, AMissingOptionIsWrong) { expect_wrong_usage({"map", "folder"}); }
TEST(Usage, AnUnknownFeatureKindIsWrong) { expect_wrong_usage({"map", "folder", "--out", "run", "--features", "harris"}); }
TEST(Usage, NoThreadsIsWrong) { expect_wrong_usage({"map", "folder", "--out", "run", "--threads", "0"}); }
TEST(Usage, TextForANumberIsWrong) { expect_wrong_usage({"optimize", "a", "--out", "b", "--max-iterations", "many"}); }

}  // namespace
}  // namespace fabloop
