// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "apps/lab/lab_settings.h"
#include "tests/apps/program.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;
using testing::HasSubstr;

TEST(Lab, MakesTheTablesOfADescriptionAndGoesOnWhereItWas) {
  const test::ScratchFolder folder;
  const fs::path sequence = tiny_sequence();
  const fs::path description =
      folder.write("small.yaml", "data: {sequences: [{folder: " + sequence.filename().string() +
                                     "}]}\nmethods: [seqslam]\nstages: [appearance]\nfeatures: {max_features: 100}\n");
  const std::vector<std::string> command = {
      "lab",    description.string(), "--out", (folder.path() / "out").string(), "--data", sequence.parent_path().string(),
      "--quiet"};
  const ProgramResult first = run_fabloop(command);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("1 cells\n"));
  const std::string table = bytes_of(folder.path() / "out" / "table.md");
  EXPECT_THAT(table, HasSubstr("# small"));
  EXPECT_THAT(table, HasSubstr("SeqSLAM-style, not the authors' code"));
  const ProgramResult again = run_fabloop(command);
  EXPECT_THAT(again.out, HasSubstr("of which 1 were there already"));
  EXPECT_EQ(bytes_of(folder.path() / "out" / "table.md"), table);
}

TEST(Lab, BadDescriptionsAreRefused) {
  const test::ScratchFolder folder;
  const fs::path description = folder.write("bad.yaml", "methods: [fabmap]\nstagess: [appearance]\n");
  expect_refused(run_fabloop({"lab", description.string(), "--out", (folder.path() / "out").string(), "--quiet"}),
                 "bad.yaml:2: 'stagess'");
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
  expect_refused(run_fabloop({"lab", "absent.yaml", "--out", (folder.path() / "out").string(), "--quiet"}), "absent.yaml");
  EXPECT_EQ(run_fabloop({"lab"}).exit_code, 2);
}

TEST(Lab, TheDescriptionsOfThisRepositoryAreGood) {
  for (const auto& entry : fs::directory_iterator(fs::path(FABLOOP_SOURCE_DIR) / "data" / "lab")) {
    if (entry.path().extension() != ".yaml") continue;
    const test::ScratchFolder folder;
    // Nothing is run: the folder holds something else. A bad description would have been refused before that.
    folder.write("thesis.tex", "dear reader");
    const std::string data = (fs::path(FABLOOP_SHARED_DATA_DIR) / "aerial").string();
    const ProgramResult result =
        run_fabloop({"lab", entry.path().string(), "--out", folder.path().string(), "--data", data, "--quiet"});
    EXPECT_EQ(result.exit_code, 1);
    const bool lacks_data = result.err.find("there is no such sequence") != std::string::npos;
    EXPECT_TRUE(lacks_data || result.err.find("holds something else") != std::string::npos) << result.err;
  }
}

TEST(Lab, EveryParameterIsListed) {
  const ProgramResult result = run_fabloop({"lab", "--parameters"});
  EXPECT_EQ(result.exit_code, 0);
  for (const LabParameter& parameter : lab_parameters())
    EXPECT_THAT(result.out, HasSubstr("  " + std::string(parameter.name) + " ("));
}

}  // namespace
}  // namespace fabloop
