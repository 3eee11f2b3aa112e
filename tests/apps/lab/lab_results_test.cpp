// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "apps/lab/cell_file.h"
#include "apps/lab/lab_figures.h"
#include "apps/lab/lab_tables.h"
#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

JudgedHypothesis hypothesis(std::size_t query, std::size_t match, double score, int passed, bool is_true) {
  JudgedHypothesis h;
  h.query = query;
  h.match = match;
  h.score = score;
  h.num_stages_passed = passed;
  if (passed >= 3) h.p_true = 0.9;
  h.place = h.closure = is_true ? MatchTruth::True : MatchTruth::False;
  return h;
}

/// Ten queries, each with a true pair and a false one. All true ones are proven, and every second false one.
MethodResult method_result(double best_false_score) {
  MethodResult method{"tf-idf", "TF-IDF", {}, {}};
  method.run.recipe = "by hand";
  for (std::size_t q = 20; q < 30; ++q) {
    method.run.queries.push_back({q, 1, 10});
    method.run.hypotheses.push_back(hypothesis(q, q - 20, 0.5, 4, true));
    method.run.hypotheses.push_back(hypothesis(q, q - 15, best_false_score, q % 2 == 0 ? 4 : 2, false));
  }
  BackEndTrial trial;
  trial.name = "map";
  trial.ate_m = 2.0;
  for (const JudgedHypothesis& h : method.run.hypotheses) {
    if (h.num_stages_passed < 4) continue;
    // One false loop slips through.
    trial.loops.push_back({h.query, h.match, h.place == MatchTruth::True || h.query == 20, false, MatchTruth::NotJudged});
  }
  trial.loops.push_back({25, 2, true, true, MatchTruth::False});
  trial.loops.push_back({26, 2, false, true, MatchTruth::False});
  method.back_ends.push_back(trial);
  return method;
}

LabDescription description() {
  LabDescription lab;
  lab.title = "By hand";
  lab.synthetic.emplace();
  lab.seeds = {1, 2};
  lab.sweep = {{lab_parameter("aliasing"), {0.0, 0.5}}};
  lab.methods = {{"tf-idf", PlaceMethod::TfIdf, ""}};
  lab.stages = {Stage::Appearance, Stage::Geometry, Stage::BackEnd};
  lab.back_ends = {{"map", std::nullopt}};
  lab.evaluation.bootstrap.num_resamples = 20;
  return lab;
}

std::vector<FinishedCell> finished_cells() {
  std::vector<FinishedCell> cells;
  for (const LabCell& cell : cells_of(description(), {})) {
    CellResult result;
    result.num_frames = 30;
    result.odometry_ate_m = 4.0 * static_cast<double>(cell.seed);
    // With aliasing the false ones look better than the true ones.
    result.methods.push_back(method_result(cell.settings.aliasing > 0.0 ? 0.7 : 0.3));
    cells.push_back({cell, result});
  }
  return cells;
}

TEST(LabResults, CountsAreThoseOfTheRunsAndPooledOnesTheirSums) {
  const LabResults results = evaluate_cells(finished_cells(), description(), 1);
  ASSERT_EQ(results.cells.size(), 4u);
  ASSERT_EQ(results.pooled.size(), 2u);
  const MethodRows& one = results.cells[0];
  EXPECT_EQ(one.seed, 1u);
  ASSERT_EQ(one.stages.size(), 3u);
  EXPECT_EQ(one.stages[0].stage, "appearance");
  EXPECT_EQ(one.stages[0].result.score, "score") << "this method claims no probability";
  EXPECT_EQ(one.stages[0].result.num_false, 10u);
  EXPECT_EQ(one.stages[1].stage, "geometry");
  EXPECT_EQ(one.stages[1].result.num_true, 10u);
  EXPECT_EQ(one.stages[1].result.num_false, 5u);
  EXPECT_EQ(one.stages[2].stage, "back end: map");
  EXPECT_EQ(one.stages[2].result.num_true, 10u);
  EXPECT_EQ(one.stages[2].result.num_false_before, 7u) << "five of its own and two injected";
  EXPECT_EQ(one.stages[2].result.num_false, 2u) << "one of its own and one injected";
  const MethodRows& all = results.pooled[0];
  EXPECT_FALSE(all.seed.has_value());
  EXPECT_EQ(all.num_queries, 20u);
  EXPECT_EQ(all.stages[1].result.num_false, 10u);
  EXPECT_EQ(all.stages[2].result.num_false, 4u);
  EXPECT_EQ(all.odometry_ate_m, 6.0);
  EXPECT_EQ(all.stages[2].ate_m, 2.0);
}

TEST(LabResults, PrecisionAndRecallAreOverTheQueriesOfAllSeeds) {
  const LabResults results = evaluate_cells(finished_cells(), description(), 2);
  EXPECT_EQ(results.pooled[0].stages[0].result.average_precision.value, 1.0);
  ASSERT_TRUE(results.pooled[0].stages[0].result.curve.has_value());
  EXPECT_EQ(results.pooled[0].stages[0].result.curve->num_positives, 20u);
  EXPECT_EQ(results.pooled[1].stages[0].result.average_precision.value, 0.0) << "every query's best is false";
}

TEST(LabResults, AnInjectedLoopDoesNotSpeakForTheRunsOwn) {
  MethodResult method = method_result(0.3);
  BackEndTrial& trial = method.back_ends[0];
  for (TriedLoop& loop : trial.loops) loop.is_kept = loop.is_injected;
  const JudgedRun judged = with_back_end(method.run, trial);
  for (std::size_t i = 0; i < method.run.hypotheses.size(); ++i) EXPECT_LE(judged.hypotheses[i].num_stages_passed, 4);
  ASSERT_EQ(judged.hypotheses.size(), method.run.hypotheses.size() + 2);
  EXPECT_EQ(judged.hypotheses.back().num_stages_passed, 5);
}

TEST(LabResults, WhereLoopsWereInjectedABackEndHasNoRanking) {
  const auto back_end_of = [](const std::vector<FinishedCell>& cells) {
    return evaluate_cells(cells, description(), 1).pooled[0].stages[2].result;
  };
  std::vector<FinishedCell> cells = finished_cells();
  const StageResult injected = back_end_of(cells);
  EXPECT_FALSE(injected.average_precision.value.has_value());
  EXPECT_FALSE(injected.recall_at_full_precision.value.has_value());
  EXPECT_FALSE(injected.expected_calibration_error.value.has_value());
  EXPECT_FALSE(injected.brier_score.value.has_value());
  EXPECT_FALSE(injected.curve.has_value());
  EXPECT_TRUE(injected.precision.value.has_value());
  for (FinishedCell& cell : cells) {
    for (MethodResult& method : cell.result.methods)
      std::erase_if(method.back_ends[0].loops, [](const TriedLoop& loop) { return loop.is_injected; });
  }
  const StageResult own = back_end_of(cells);
  EXPECT_TRUE(own.average_precision.value.has_value());
  EXPECT_TRUE(own.brier_score.value.has_value());
}

TEST(LabTables, TheTidyTableHasALineACellMethodAndStage) {
  const test::ScratchFolder folder;
  const LabResults results = evaluate_cells(finished_cells(), description(), 1);
  write_results_csv(folder.path() / "results.csv", results, description());
  std::ifstream file(folder.path() / "results.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_THAT(line, testing::StartsWith("data,seed,cells,aliasing,method,label,stage,score,queries,true_before"));
  const auto num_columns = std::count(line.begin(), line.end(), ',');
  std::size_t num_lines = 0;
  while (std::getline(file, line)) {
    ++num_lines;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), num_columns) << line;
  }
  EXPECT_EQ(num_lines, (4u + 2u) * 3u);
}

TEST(LabTables, ReadersSeeSharesWithIntervals) {
  const std::string text = results_markdown(evaluate_cells(finished_cells(), description(), 1), description());
  EXPECT_THAT(text, HasSubstr("# By hand"));
  EXPECT_THAT(text, HasSubstr("| synthetic, aliasing 0 | TF-IDF | 20 | 20 of 40, 50.0 % [50.0, 50.0] | 10 of 30, 33.3 % ["));
  EXPECT_THAT(text, HasSubstr("| synthetic, aliasing 0.5 | TF-IDF | map | 20 of 20 | 4 of 14 | 6.00 | 2.00 |"));
  EXPECT_THAT(text, HasSubstr("\nRecipe (synthetic, aliasing 0; synthetic, aliasing 0.5): by hand"));
}

TEST(LabTables, EachRecipeIsToldWithTheDataThatItIsOf) {
  LabResults results = evaluate_cells(finished_cells(), description(), 1);
  results.pooled[0].recipe = "within 10 % of 20 m";
  results.pooled[1].recipe = "within 10 % of 52 m";
  const std::string text = results_markdown(results, description());
  EXPECT_THAT(text, HasSubstr("\nRecipe (synthetic, aliasing 0): within 10 % of 20 m.\n"));
  EXPECT_THAT(text, HasSubstr("\nRecipe (synthetic, aliasing 0.5): within 10 % of 52 m.\n"));
}

TEST(LabTables, NoneOfManyIsToldWithWhatItProves) {
  // (1 - p)^300 = 0.05 has p = 0.994 %.
  EXPECT_EQ(share_text(0, 300, std::nullopt), "0 of 300 (< 0.99 %)");
  EXPECT_EQ(share_text(0, 0, std::nullopt), "0 of 0");
  EXPECT_EQ(share_text(3, 300, Interval{0.002, 0.021}), "3 of 300, 1.0 % [0.2, 2.1]");
}

TEST(LabFigures, EachGroupHasItsPicture) {
  const test::ScratchFolder folder;
  write_lab_figures(folder.path(), evaluate_cells(finished_cells(), description(), 1), description());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "precision_recall_1.png"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "precision_recall_2.png"));
}

TEST(LabFigures, ASweepIsDrawnWhereAnythingPassed) {
  const std::string name = "false_share_synthetic_tf-idf.png";
  const auto draw = [&](const LabResults& results) {
    const test::ScratchFolder folder;
    write_lab_figures(folder.path(), results, description());
    return cv::imread((folder.path() / name).string());
  };
  LabResults results = evaluate_cells(finished_cells(), description(), 1);
  EXPECT_FALSE(draw(results).empty());
  // One point alone, at either end of the sweep, is drawn there.
  const auto forget = [](MethodRows& rows) {
    for (StageRow& row : rows.stages) row.result.precision = {};
  };
  LabResults first = results, last = results;
  forget(first.pooled[1]);
  forget(last.pooled[0]);
  const cv::Mat at_low = draw(first), at_high = draw(last);
  ASSERT_FALSE(at_low.empty());
  ASSERT_EQ(at_low.size(), at_high.size());
  // What differs is at the left and the right edge of the plot, nowhere between.
  cv::Mat difference;
  cv::cvtColor(cv::Mat(at_low != at_high), difference, cv::COLOR_BGR2GRAY);
  const cv::Mat plot = difference.rowRange(difference.rows / 4, difference.rows);
  EXPECT_GT(cv::countNonZero(plot.colRange(0, plot.cols / 4)), 0);
  EXPECT_GT(cv::countNonZero(plot.colRange(3 * plot.cols / 4, plot.cols)), 0);
  EXPECT_EQ(cv::countNonZero(plot.colRange(plot.cols / 4, 3 * plot.cols / 4)), 0);
  forget(first.pooled[0]);
  EXPECT_TRUE(draw(first).empty()) << "nothing to draw";
}

TEST(CellFile, NumbersComeBackExactly) {
  const test::ScratchFolder folder;
  FinishedCell cell = finished_cells()[1];
  MethodResult& method = cell.result.methods[0];
  method.run.hypotheses[0].score = std::numeric_limits<double>::infinity();
  method.run.hypotheses[1].score = 0.1 + 0.2;
  method.run.hypotheses[2].probability = 1.0 / 3.0;
  method.run.hypotheses[3].closure = MatchTruth::NotJudged;
  const auto path = folder.path() / "cell.json";
  write_cell(path, "abc", cell.cell, cell.result);
  const auto read = read_cell(path, "abc");
  ASSERT_TRUE(read.has_value());
  const MethodResult& back = read->methods[0];
  EXPECT_EQ(back.run.hypotheses[0].score, std::numeric_limits<double>::infinity());
  EXPECT_EQ(back.run.hypotheses[1].score, 0.1 + 0.2);
  EXPECT_EQ(back.run.hypotheses[2].probability, 1.0 / 3.0);
  EXPECT_EQ(back.run.hypotheses[3].closure, MatchTruth::NotJudged);
  write_cell(folder.path() / "again.json", "abc", cell.cell, *read);
  const auto text = [](const std::filesystem::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file).rdbuf();
    return bytes.str();
  };
  EXPECT_EQ(text(folder.path() / "again.json"), text(path));
}

TEST(CellFile, DamagedFilesAndOtherCellsAreRefused) {
  const test::ScratchFolder folder;
  const FinishedCell cell = finished_cells()[0];
  const auto path = folder.path() / "cell.json";
  EXPECT_FALSE(read_cell(path, "abc").has_value()) << "there is none yet";
  write_cell(path, "abc", cell.cell, cell.result);
  EXPECT_THAT(test::message_of<InputError>([&] { read_cell(path, "abd"); }), HasSubstr("is the result of another cell"));
  folder.write("cell.json", "{\"checksum\": \"abc\"");
  EXPECT_THAT(test::message_of<InputError>([&] { read_cell(path, "abc"); }), HasSubstr("remove the file"));
}

}  // namespace
}  // namespace fabloop
