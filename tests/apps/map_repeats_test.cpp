// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <set>

#include "tests/apps/map_run.h"
#include "tests/apps/same_runs.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

void run_map(const fs::path& out, const std::string& num_threads) {
  auto command = map_command(tiny_sequence(), out, {"--max-features", "200"});
  command.insert(command.end(), {"--threads", num_threads});
  const ProgramResult result = run_fabloop(command);
  ASSERT_EQ(result.exit_code, 0) << result.err;
}

TEST(MapRepeats, TheSameBytesEachTimeWithAnyNumberOfThreads) {
  const test::ScratchFolder scratch;
  run_map(scratch.path() / "a", "2");
  run_map(scratch.path() / "b", "2");
  run_map(scratch.path() / "c", "1");
  expect_same_runs(scratch.path() / "a", scratch.path() / "b");
  expect_same_runs(scratch.path() / "a", scratch.path() / "c");
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"a", "b", "c"})) << "a part was left";
}

}  // namespace
}  // namespace fabloop
