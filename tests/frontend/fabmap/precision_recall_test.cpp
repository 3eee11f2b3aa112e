// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/precision_recall.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "frontend/error.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

constexpr double kTolerance = 1e-12;

/// Frame pairs are true where the matrix has a one.
GroundTruth truth_of(std::size_t queries, std::size_t matches, std::vector<std::uint8_t> entries,
                     const ExclusionWindow& window = {}) {
  return truth_from_matrix({queries, matches, std::move(entries)}, window);
}

/// Each place is one frame.
PlaceFrames single_frames(std::size_t num_places) {
  PlaceFrames places;
  for (std::size_t i = 0; i < num_places; ++i) places.push_back({i});
  return places;
}

TEST(PrecisionRecall, ACurveByHand) {
  // Sorted: 0.9 true, 0.8 false, 0.7 true, 0.1 false; three could be true.
  const auto curve = precision_recall_curve({{0.7, true}, {0.8, false}, {0.9, true}, {0.1, false}}, 3);
  ASSERT_EQ(curve.points.size(), 4u);
  const std::vector<std::array<double, 3>> expected = {
      {0.9, 1, 1.0 / 3}, {0.8, 0.5, 1.0 / 3}, {0.7, 2.0 / 3, 2.0 / 3}, {0.1, 0.5, 2.0 / 3}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(curve.points[i].threshold, expected[i][0]);
    EXPECT_NEAR(curve.points[i].precision, expected[i][1], kTolerance);
    EXPECT_NEAR(curve.points[i].recall, expected[i][2], kTolerance);
  }
  EXPECT_NEAR(curve.average_precision, 1.0 / 3 * 1 + 1.0 / 3 * 2.0 / 3, kTolerance);
  EXPECT_NEAR(curve.area_trapezoidal, 1.0 / 3 * 1 + 1.0 / 3 * (0.5 + 2.0 / 3) / 2, kTolerance);
  EXPECT_NEAR(curve.recall_at_full_precision, 1.0 / 3, kTolerance);
  EXPECT_EQ(curve.full_precision_threshold, 0.9);
}

TEST(PrecisionRecall, TheExampleOfTheUsersGuideOfScikitLearn) {
  // average_precision_score([0, 0, 1, 1], [0.1, 0.4, 0.35, 0.8]) = 0.8333...
  const auto curve = precision_recall_curve({{0.1, false}, {0.4, false}, {0.35, true}, {0.8, true}}, 2);
  EXPECT_NEAR(curve.average_precision, 0.5 + 0.5 * 2.0 / 3, kTolerance);
}

TEST(PrecisionRecall, EqualScoresAreAcceptedTogether) {
  const auto curve = precision_recall_curve({{1, true}, {1, false}, {1, true}, {0, true}}, 3);
  ASSERT_EQ(curve.points.size(), 2u);
  EXPECT_NEAR(curve.points[0].precision, 2.0 / 3, kTolerance);
  EXPECT_NEAR(curve.points[0].recall, 2.0 / 3, kTolerance);
  EXPECT_EQ(curve.recall_at_full_precision, 0.0) << "a false answer scores as high as the best";
  EXPECT_FALSE(curve.full_precision_threshold);
  EXPECT_NEAR(curve.average_precision, 2.0 / 3 * 2.0 / 3 + 1.0 / 3 * 0.75, kTolerance);
}

TEST(PrecisionRecall, PerfectAnswersGiveOne) {
  const auto curve = precision_recall_curve({{3, true}, {2, true}, {1, false}}, 2);
  EXPECT_NEAR(curve.average_precision, 1.0, kTolerance);
  EXPECT_NEAR(curve.area_trapezoidal, 1.0, kTolerance);
  EXPECT_EQ(curve.recall_at_full_precision, 1.0);
  EXPECT_EQ(curve.full_precision_threshold, 2.0);
}

TEST(PrecisionRecall, InfiniteScoresAreScores) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto curve = precision_recall_curve({{kInfinity, true}, {-kInfinity, false}}, 1);
  EXPECT_EQ(curve.average_precision, 1.0);
}

TEST(PrecisionRecall, WhatMakesNoSenseIsRefused) {
  EXPECT_THROW(precision_recall_curve({{1, true}}, 0), InputError);
  EXPECT_THROW(precision_recall_curve({{1, true}, {2, true}}, 1), InputError);
  EXPECT_THROW(precision_recall_curve({{std::nan(""), true}}, 1), InputError);
  EXPECT_TRUE(precision_recall_curve({}, 3).points.empty());
}

TEST(PrecisionRecall, QueriesWithoutATrueMatchCountAgainstPrecisionAlone) {
  const GroundTruth truth = truth_of(3, 2,
                                     {1, 0,  //
                                      0, 0,  //
                                      0, 1});
  const std::vector<ScoredQuery> queries = {{0, 2, {{0, 5.0}, {1, 1.0}}}, {1, 2, {{1, 4.0}}}, {2, 2, {{0, 2.0}, {1, 1.0}}}};
  const PrecisionRecall result = evaluate_recognition(queries, single_frames(2), truth, {.recall_at = {1, 2}});
  EXPECT_EQ(result.num_queries_with_true_match, 2u);
  EXPECT_EQ(result.num_decisions, 3u);
  ASSERT_TRUE(result.curve);
  EXPECT_EQ(result.curve->num_positives, 2u);
  EXPECT_NEAR(result.curve->average_precision, 0.5, kTolerance);
  EXPECT_NEAR(result.curve->recall_at_full_precision, 0.5, kTolerance);
  EXPECT_EQ(result.recall_at[0].recall, 0.5);
  EXPECT_EQ(result.recall_at[1].recall, 1.0);
  EXPECT_THAT(result.recipe, HasSubstr("top-1"));
  EXPECT_THAT(result.recipe, HasSubstr("2 queries that have a true match, of 3"));
}

TEST(PrecisionRecall, EveryMatchCanBeScored) {
  const GroundTruth truth = truth_of(1, 3, {1, 0, 1});
  const PrecisionRecall result =
      evaluate_recognition({{0, 3, {{0, 3.0}, {1, 2.0}, {2, 1.0}}}}, single_frames(3), truth, {.scored = Scored::EveryMatch});
  EXPECT_EQ(result.curve->num_positives, 2u);
  EXPECT_NEAR(result.curve->average_precision, 0.5 * 1.0 + 0.5 * 2.0 / 3, kTolerance);
  EXPECT_NEAR(result.curve->recall_at_full_precision, 0.5, kTolerance);
}

TEST(PrecisionRecall, WithinOneSequenceOnlyEarlierFramesOutsideTheWindowCount) {
  // 0 and 3 show one place; so do 3 and 4, which are neighbours.
  const GroundTruth truth = truth_of(5, 5, {0, 0, 0, 1, 0,  //
                                            0, 0, 0, 0, 0,  //
                                            0, 0, 0, 0, 0,  //
                                            1, 0, 0, 0, 1,  //
                                            0, 0, 0, 1, 0},
                                     1);
  std::vector<ScoredQuery> queries;
  for (std::size_t i = 0; i < 5; ++i) queries.push_back({i, i, {}});
  queries[3].matches = {{2, 9.0}, {0, 5.0}};
  queries[4].matches = {{3, 9.0}};
  const PrecisionRecall result = evaluate_recognition(queries, single_frames(5), truth);
  EXPECT_EQ(result.num_queries_with_true_match, 1u) << "frame 0 has its match later, frame 4 in the window";
  EXPECT_EQ(result.num_decisions, 1u);
  EXPECT_EQ(result.curve->recall_at_full_precision, 1.0) << "the neighbour is passed over";
  EXPECT_EQ(result.recall_at[0].recall, 1.0);
}

TEST(PrecisionRecall, APlaceIsTrueWhenOneOfItsFramesIs) {
  const GroundTruth truth = truth_of(1, 3, {0, 0, 1});
  EXPECT_EQ(judge_place(truth, 0, {0, 2}), MatchTruth::True);
  EXPECT_EQ(judge_place(truth, 0, {0, 1}), MatchTruth::False);
  EXPECT_EQ(judge_place(truth, 0, {}), MatchTruth::NotJudged);
}

TEST(PrecisionRecall, WithoutPositivesThereIsNoCurve) {
  const PrecisionRecall result = evaluate_recognition({{0, 1, {{0, 1.0}}}}, single_frames(1), truth_of(1, 1, {0}));
  EXPECT_FALSE(result.curve);
  EXPECT_EQ(result.num_decisions, 1u);
}

TEST(PrecisionRecall, FramesBeyondTheTruthAndBadScoresAreRefused) {
  const GroundTruth truth = truth_of(1, 1, {1});
  EXPECT_THROW(evaluate_recognition({{1, 1, {{0, 1.0}}}}, single_frames(1), truth), InputError);
  EXPECT_THROW(evaluate_recognition({{0, 1, {{0, 1.0}}}}, single_frames(2), truth), InputError);
  EXPECT_THROW(evaluate_recognition({{0, 1, {{0, std::nan("")}}}}, single_frames(1), truth), InputError);
}

}  // namespace
}  // namespace fabloop
