// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/apps/map_run.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop::testing_support {
namespace {

namespace fs = std::filesystem;

/// The tiny flight, mapped; its page is in the folder.
class MappedFlight {
 public:
  MappedFlight() {
    const ProgramResult result = run_fabloop(map_command(tiny_sequence(), run(), kFewFeatures));
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  fs::path run() const { return scratch_.path() / "run"; }
  fs::path in_scratch(const char* name) const { return scratch_.path() / name; }

 private:
  test::ScratchFolder scratch_;
};

TEST(Report, HoldsTheRunAndNeedsNothingElse) {
  const MappedFlight flight;
  const std::string page = bytes_of(flight.run() / "report.html");
  const auto data = data_of(page);
  const std::size_t num_rows = data.at("ledger").at("query").size();
  EXPECT_EQ(num_rows, data.at("summary").at("loops").at("hypotheses").get<std::size_t>());
  EXPECT_EQ(data.at("inliers").at("counts").size(), num_rows);
  EXPECT_EQ(data.at("truth").at("rows").size(), num_rows);
  EXPECT_EQ(data.at("images").at("jpegs").size(), data.at("frames").size());
  EXPECT_GE(data.at("truth").at("evaluation").at("stages").size(), 4U);
  for (const char* remote : {"src=\"http", "href=\"http", "url(http", "@import"})
    EXPECT_EQ(page.find(remote), std::string::npos) << remote;
  constexpr std::size_t kMaxBytes = 15U << 20U;
  EXPECT_LT(page.size(), kMaxBytes);
}

TEST(Report, WithoutTruthAndImagesIsMadeFromTheRunAlone) {
  const MappedFlight flight;
  const fs::path page = flight.in_scratch("page.html");
  const ProgramResult result = run_fabloop({"report", flight.run().string(), "--out", page.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto data = data_of(bytes_of(page));
  EXPECT_TRUE(data.at("truth").is_null());
  EXPECT_TRUE(data.at("images").is_null());
  EXPECT_GT(data.at("map").at("final").size(), 0U);
  expect_refused(run_fabloop({"report", flight.in_scratch("nothing").string()}), "nothing");
  expect_refused(run_fabloop({"report", flight.run().string(), "--images", flight.run().string(), "--out", page.string()}),
                 "run");
}

TEST(Explain, TellsThePairAndDrawsIt) {
  const MappedFlight flight;
  const auto ledger = data_of(bytes_of(flight.run() / "report.html")).at("ledger");
  const std::string query = std::to_string(ledger.at("query").at(0).get<int>()),
                    match = std::to_string(ledger.at("match").at(0).get<int>());
  const fs::path picture = flight.in_scratch("pair.png");
  const ProgramResult result = run_fabloop(
      {"explain", flight.run().string(), query, match, "--sequence", tiny_sequence().string(), "--picture", picture.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find(ledger.at("verdict").at(0).get<std::string>()), std::string::npos) << result.out;
  EXPECT_GT(fs::file_size(picture), 10000U);
  expect_refused(run_fabloop({"explain", flight.run().string(), match, query}), "later image first");
  expect_refused(run_fabloop({"explain", flight.run().string(), "100000", "0"}), "frames.csv");
}

TEST(Explain, DrawsWhatARunMatchedByWordsWithItsModelAlone) {
  const test::ScratchFolder scratch;
  const std::string model = (scratch.path() / "tiny.model").string(), run = (scratch.path() / "run").string();
  const ProgramResult trained =
      run_fabloop({"train", tiny_sequence().string(), "--out", model, "--max-features", "300", "--quiet"});
  ASSERT_EQ(trained.exit_code, 0) << trained.err;
  const ProgramResult mapped = run_fabloop(map_command(tiny_sequence(), run, {"--model", model, "--match-by", "words"}));
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  const auto ledger = data_of(bytes_of(fs::path(run) / "report.html")).at("ledger");
  const auto picture = [&](const std::vector<std::string>& more) {
    const std::string path = (scratch.path() / "pair.png").string();
    std::vector<std::string> command = {"explain",
                                        run,
                                        std::to_string(ledger.at("query").at(0).get<int>()),
                                        std::to_string(ledger.at("match").at(0).get<int>()),
                                        "--sequence",
                                        tiny_sequence().string(),
                                        "--picture",
                                        path};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = run_fabloop(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return bytes_of(path);
  };
  const std::string without = picture({}), with = picture({"--model", model});
  EXPECT_NE(with, without) << "the other matches are drawn";
}

TEST(ReportInABrowser, EveryControlWorks) {
  const MappedFlight flight;
  const std::string command =
      "/usr/bin/python3 " FABLOOP_SOURCE_DIR "/tests/apps/report_in_browser.py " + (flight.run() / "report.html").string();
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  constexpr int kSkipped = 77;
  if (WEXITSTATUS(status) == kSkipped)
    GTEST_SKIP() << "Chromium, its driver or Selenium is not installed (Debian: chromium-driver, python3-selenium)";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace fabloop::testing_support
