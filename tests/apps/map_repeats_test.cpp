// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/apps/map_run.h"
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

/// What a summary says, but for how long it took.
nlohmann::json summary_without_timings(const fs::path& path) {
  nlohmann::json summary = nlohmann::json::parse(bytes_of(path));
  EXPECT_EQ(summary.erase("timings"), 1U);
  EXPECT_EQ(summary.erase("peak_memory_mib"), 1U);
  return summary;
}

void expect_same_runs(const fs::path& a, const fs::path& b) {
  ASSERT_EQ(names_in(a), names_in(b));
  for (const std::string& name : names_in(a)) {
    if (name == "summary.json") {
      EXPECT_EQ(summary_without_timings(a / name), summary_without_timings(b / name));
    } else if (name != "report.html") {  // it shows the timings
      EXPECT_TRUE(bytes_of(a / name) == bytes_of(b / name)) << name << " differs";
    }
  }
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
