// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/stage_evaluation.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/evaluation/explanation.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

/// Thirty frames on a line; frames i and i + 15 show one place, all other pairs more than 5 apart do not.
struct Scene {
  Scene() {
    for (std::size_t k = 0; k < 30; ++k) {
      loops.world_from_camera.push_back(Pose{Eigen::Quaterniond::Identity(), {10.0 * static_cast<double>(k % 15), 0, 0}});
    }
    places.num_queries = places.num_matches = 30;
    places.within_one_sequence = true;
    places.recipe = "same place: 15 apart";
    places.at = [](std::size_t query, std::size_t match) {
      const std::size_t gap = query > match ? query - match : match - query;
      if (gap <= 5) return MatchTruth::NotJudged;
      return gap == 15 ? MatchTruth::True : MatchTruth::False;
    };
  }

  void add(std::size_t query, std::size_t match, double probability, const std::string& verdict, double p_true, double x = 0.0) {
    LedgerRow row;
    row.loop = {query, match, verdict, true, std::nullopt};
    if (p_true > 0.0) row.loop.match_from_query = Pose{Eigen::Quaterniond::Identity(), {x, 0, 1e-3}};
    row.figures = {static_cast<double>(query), static_cast<double>(match), probability, 50.0, p_true};
    ledger.rows.push_back(row);
  }
  StageEvaluation evaluate(const StageOptions& options = {.bootstrap = {.num_resamples = 50}}) const {
    return evaluate_stages(judge_run(ledger, places, loops), options);
  }

  GroundTruth places;
  LoopTruth loops;
  LedgerTable ledger{{"query", "match", "probability", "matches", "p_true"}, {}};
};

const StageResult& stage(const StageEvaluation& evaluation, Stage which) {
  for (const StageResult& result : evaluation.stages) {
    if (result.stage == which) return result;
  }
  throw std::logic_error("no such stage");
}

TEST(StageEvaluation, CountsWhatEachStageLetsThrough) {
  Scene scene;
  scene.add(15, 0, 0.9, "Accepted", 0.99);
  scene.add(16, 1, 0.8, "TooFewMatches", 0);
  scene.add(17, 2, 0.7, "TooFewInliers", 0);
  scene.add(18, 3, 0.6, "ContradictsMap", 0.9);
  scene.add(19, 2, 0.9, "TooFewMatches", 0);
  scene.add(20, 2, 0.9, "AccidentalInliers", 0.1);
  scene.add(21, 2, 0.9, "ContradictsMap", 0.8);
  scene.add(22, 2, 0.9, "Accepted", 0.7);
  scene.add(23, 20, 0.9, "Accepted", 0.7, 30.0);  // too near to be judged, and its pose is right
  const StageEvaluation found = scene.evaluate();
  ASSERT_EQ(found.stages.size(), 4U) << "consistency was off";
  EXPECT_EQ(found.num_queries_with_true_match, 15U);
  const auto counts = [&](Stage which) {
    const StageResult& result = stage(found, which);
    return std::array<std::size_t, 5>{result.num_true_before, result.num_false_before, result.num_true, result.num_false,
                                      result.num_unjudged};
  };
  constexpr std::size_t kPairs = 30 * 29 / 2, kNear = 24 * 5 + 5 * 4 / 2 + 5, kTrue = 15;
  EXPECT_EQ(counts(Stage::Appearance), (std::array<std::size_t, 5>{kTrue, kPairs - kNear - kTrue, 4, 4, 1}));
  EXPECT_EQ(counts(Stage::Matching), (std::array<std::size_t, 5>{4, 4, 3, 3, 1}));
  EXPECT_EQ(counts(Stage::Geometry), (std::array<std::size_t, 5>{3, 3, 2, 2, 1}));
  EXPECT_EQ(counts(Stage::BackEnd), (std::array<std::size_t, 5>{2, 2, 1, 1, 1}));
  EXPECT_DOUBLE_EQ(*stage(found, Stage::Matching).false_rejection.value, 0.25);
  EXPECT_DOUBLE_EQ(*stage(found, Stage::BackEnd).false_rejection.value, 0.5);
  EXPECT_DOUBLE_EQ(*stage(found, Stage::Geometry).query_recall.value, 2.0 / 15.0);
}

TEST(StageEvaluation, WrongPosesAreFalseFromGeometryOn) {
  Scene scene;
  scene.add(15, 0, 0.9, "Accepted", 0.9, 50.0);  // the place is right, the pose 50 m off
  const StageEvaluation found = scene.evaluate();
  EXPECT_EQ(stage(found, Stage::Matching).num_true, 1U);
  EXPECT_EQ(stage(found, Stage::Geometry).num_true, 0U);
  EXPECT_EQ(stage(found, Stage::Geometry).num_false, 1U);
  EXPECT_NEAR(*stage(found, Stage::Geometry).brier_score.value, 0.81, 1e-12);
}

TEST(StageEvaluation, ARightPoseProvesAPlaceThatNothingElseJudges) {
  Scene scene;
  scene.places.at = [](std::size_t, std::size_t) { return MatchTruth::NotJudged; };
  scene.add(15, 0, 0.9, "Accepted", 0.9);
  scene.add(16, 1, 0.9, "Accepted", 0.9, 50.0);  // a wrong pose proves nothing: the place stays unjudged, the loop is false
  scene.add(17, 2, 0.9, "TooFewMatches", 0);
  scene.add(23, 20, 0.9, "Accepted", 0.7, 30.0);  // too near
  const StageEvaluation found = scene.evaluate();
  EXPECT_EQ(found.num_queries_with_true_match, 1U);
  EXPECT_EQ(stage(found, Stage::Appearance).num_true, 1U);
  EXPECT_EQ(stage(found, Stage::Appearance).num_unjudged, 3U);
  EXPECT_EQ(stage(found, Stage::Geometry).num_true, 1U);
  EXPECT_EQ(stage(found, Stage::Geometry).num_false, 1U);
  EXPECT_EQ(stage(found, Stage::Geometry).num_unjudged, 1U);

  scene.loops.pairs.emplace();  // pairs are known, and this is none that overlaps enough to be one
  EXPECT_EQ(stage(scene.evaluate(), Stage::Appearance).num_true, 0U);
}

TEST(StageEvaluation, ScoresTheBestOfEachQueryAndRecallAtK) {
  Scene scene;
  scene.add(15, 0, 0.4, "Accepted", 0.99);
  scene.add(15, 1, 0.6, "TooFewMatches", 0);
  scene.add(16, 1, 0.9, "Accepted", 0.99);
  const StageResult appearance = stage(scene.evaluate(), Stage::Appearance);
  ASSERT_TRUE(appearance.curve.has_value());
  EXPECT_EQ(appearance.curve->points.size(), 2U) << "one answer a query";
  EXPECT_DOUBLE_EQ(appearance.average_precision.value.value(), 1.0 / 15.0);
  EXPECT_DOUBLE_EQ(appearance.recall_at[0].recall, 1.0 / 15.0);
  EXPECT_DOUBLE_EQ(appearance.recall_at[1].recall, 2.0 / 15.0);
}

TEST(StageEvaluation, IntervalsHoldTheFigureAndRepeat) {
  Scene scene;
  for (std::size_t query = 15; query < 30; ++query) scene.add(query, query - 15 + (query % 3 == 0), 0.5, "Accepted", 0.8);
  const StageResult first = stage(scene.evaluate({}), Stage::Geometry), again = stage(scene.evaluate({}), Stage::Geometry);
  ASSERT_TRUE(first.precision.interval.has_value());
  EXPECT_LE(first.precision.interval->low, *first.precision.value);
  EXPECT_GE(first.precision.interval->high, *first.precision.value);
  EXPECT_LT(first.precision.interval->low, first.precision.interval->high);
  EXPECT_EQ(first.precision.interval->low, again.precision.interval->low);
}

TEST(StageEvaluation, RefusesAnUnknownVerdictAndFramesBeyondTheTruth) {
  EXPECT_THROW(num_stages_passed("Perhaps"), InputError);
  Scene scene;
  scene.add(31, 2, 0.5, "Accepted", 0.5);
  EXPECT_THROW(scene.evaluate(), InputError);
}

constexpr const char* kLedger =
    "query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw,rank,p_new,session,match_session,map_chi2,"
    "map_weight\n"
    "31,4,0.75,Accepted,80,60,1,1.5,-2.25,0.5,0,0,0,1,1,0.125,0,0,2.5,0.875\n"
    "31,9,0.1,TooFewInliers,30,9,0,0,0,0,0,0,0,1,2,0.125,0,0,,\n"
    "31,5,0.1,TooFewMatches,3,0,0,0,0,0,0,0,0,1,3,0.125,1,0,,\n";

TEST(LedgerTable, KeepsEveryColumnAndOnlyThisSession) {
  const test::ScratchFolder scratch;
  scratch.write("loops.csv", kLedger);
  const LedgerTable ledger = read_ledger(scratch.path() / "loops.csv");
  ASSERT_EQ(ledger.rows.size(), 2U);
  EXPECT_EQ(ledger.figure(ledger.rows[0], "map_weight"), 0.875);
  EXPECT_EQ(ledger.figure(ledger.rows[1], "map_weight"), std::nullopt);
  EXPECT_EQ(ledger.figure(ledger.rows[0], "no_such_column"), std::nullopt);
  ASSERT_TRUE(ledger.rows[0].loop.match_from_query.has_value());
  EXPECT_EQ(ledger.rows[0].loop.match_from_query->translation, Eigen::Vector3d(1.5, -2.25, 0.5));
  EXPECT_FALSE(ledger.rows[1].loop.match_from_query.has_value());
}

TEST(Explanation, NamesTheGateAndWhatItWouldTake) {
  const test::ScratchFolder scratch;
  scratch.write("loops.csv", kLedger);
  const LedgerTable ledger = read_ledger(scratch.path() / "loops.csv");
  const Explanation refused = explain(ledger, 31, 9);
  EXPECT_EQ(refused.verdict, Verdict::TooFewInliers);
  EXPECT_EQ(refused.of_query.size(), 2U);
  EXPECT_NE(refused.words.back().find("would have to be at least 15; it is 9"), std::string::npos) << refused.words.back();
  const Explanation accepted = explain(ledger, 31, 4);
  EXPECT_NE(accepted.words.at(1).find("weight 0.875"), std::string::npos) << accepted.words.at(1);
}

TEST(Explanation, SaysWhyAPairWasNeverVerified) {
  const test::ScratchFolder scratch;
  scratch.write("loops.csv", kLedger);
  const LedgerTable ledger = read_ledger(scratch.path() / "loops.csv");
  EXPECT_FALSE(explain(ledger, 31, 7).verdict.has_value());
  EXPECT_NE(explain(ledger, 31, 7).words.at(0).find("not among the 2 most probable"), std::string::npos);
  EXPECT_NE(explain(ledger, 31, 25).words.at(0).find("10 images before"), std::string::npos);
  EXPECT_THROW(explain(ledger, 4, 31), InputError);
}

}  // namespace
}  // namespace fabloop
