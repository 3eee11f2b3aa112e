// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/loop_evaluation.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

using test::shift;

/// Frames 10 m apart on a line, 60 m up; frame 40 has no reference. Pair (0, 20) overlaps, (0, 21) by its inliers, (0, 22) is
/// unclear.
LoopTruth make_truth() {
  LoopTruth truth;
  for (int k = 0; k < 50; ++k)
    truth.world_from_camera.push_back(Pose{test::rotation_from_vector({0, 0, 0.1 * k}), {10.0 * k, 0, 60}});
  truth.world_from_camera[40].reset();
  truth.pairs.emplace();
  (*truth.pairs)[{0, 20}] = {0.5, 0};
  (*truth.pairs)[{0, 21}] = {0.0, 15};
  (*truth.pairs)[{0, 22}] = {0.1, 14};
  (*truth.pairs)[{0, 23}] = {0.04, 14};
  (*truth.pairs)[{0, 24}] = {0.3, 0};
  return truth;
}

/// An accepted loop with the true pose, off by `error` in the frame of the query.
LoopRecord accepted(const LoopTruth& truth, std::size_t query, std::size_t match, const Pose& error = {}) {
  LoopRecord record{query, match, "Accepted", true, {}};
  record.match_from_query = truth.world_from_camera[query] && truth.world_from_camera[match]
                                ? truth.world_from_camera[match]->inverse() * *truth.world_from_camera[query] * error
                                : Pose{};
  return record;
}

LoopJudgement judgement(const LoopRecord& record, const LoopTruth& truth, const LoopEvaluationOptions& options = {}) {
  return evaluate_loops({record}, truth, options).loops.at(0).judgement;
}

TEST(LoopEvaluation, PairsAreJudgedByOverlapOrInliers) {
  const LoopTruth truth = make_truth();
  EXPECT_EQ(judgement(accepted(truth, 20, 0), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(accepted(truth, 0, 20), truth), LoopJudgement::True) << "the order does not matter";
  EXPECT_EQ(judgement(accepted(truth, 21, 0), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(accepted(truth, 22, 0), truth), LoopJudgement::UnclearPair);
  EXPECT_EQ(judgement(accepted(truth, 23, 0), truth), LoopJudgement::FalsePair);
  EXPECT_EQ(judgement(accepted(truth, 30, 0), truth), LoopJudgement::FalsePair) << "absent from the list";
  EXPECT_EQ(judgement(accepted(truth, 40, 0), truth), LoopJudgement::NoReference);
}

TEST(LoopEvaluation, FramesNearInTimeAreJudgedByPoseAlone) {
  const LoopTruth truth = make_truth();
  EXPECT_EQ(judgement(accepted(truth, 15, 5), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(accepted(truth, 16, 5), truth), LoopJudgement::FalsePair);
  EXPECT_EQ(judgement(accepted(truth, 15, 5, shift(0, 7, 0)), truth), LoopJudgement::FalsePose);
}

TEST(LoopEvaluation, PosesWithScaleMustAgreeInRotationAndTranslation) {
  const LoopTruth truth = make_truth();
  EXPECT_EQ(judgement(accepted(truth, 20, 0, shift(0, 5.9, 0)), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(accepted(truth, 20, 0, shift(0, 6.1, 0)), truth), LoopJudgement::FalsePose);
  EXPECT_EQ(judgement(accepted(truth, 22, 0, shift(0, 6.1, 0)), truth), LoopJudgement::FalsePose) << "an unclear pair too";
  const auto turned = [&](double angle_deg) {
    return accepted(truth, 20, 0, {test::rotation_from_vector({rad_from_deg(angle_deg), 0, 0}), Eigen::Vector3d::Zero()});
  };
  EXPECT_EQ(judgement(turned(4.9), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(turned(5.1), truth), LoopJudgement::FalsePose);
  LoopEvaluationOptions high;
  high.height_above_ground_m = 120.0;
  EXPECT_EQ(judgement(accepted(truth, 20, 0, shift(0, 6.1, 0)), truth, high), LoopJudgement::True);
}

TEST(LoopEvaluation, PosesWithoutScaleMustAgreeInDirectionWhereThereIsABaseline) {
  LoopTruth truth = make_truth();
  const auto direction = [&](double angle_deg) {
    LoopRecord record = accepted(truth, 20, 0);
    record.has_scale = false;
    Eigen::Vector3d& translation = record.match_from_query->translation;
    translation = Eigen::AngleAxisd(rad_from_deg(angle_deg), Eigen::Vector3d::UnitZ()) * translation.normalized();
    return record;
  };
  EXPECT_EQ(judgement(direction(14), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(direction(16), truth), LoopJudgement::FalsePose);
  EXPECT_EQ(judgement(direction(180), truth), LoopJudgement::FalsePose);
  truth.world_from_camera[20]->translation = truth.world_from_camera[0]->translation + Eigen::Vector3d(5.9, 0, 0);
  EXPECT_EQ(judgement(direction(180), truth), LoopJudgement::True) << "too short a baseline to have a direction";
}

TEST(LoopEvaluation, WithoutPairsThePoseDecides) {
  LoopTruth truth = make_truth();
  truth.pairs.reset();
  EXPECT_EQ(judgement(accepted(truth, 30, 0), truth), LoopJudgement::True);
  EXPECT_EQ(judgement(accepted(truth, 30, 0, shift(0, 7, 0)), truth), LoopJudgement::FalsePose);
  EXPECT_FALSE(evaluate_loops({accepted(truth, 30, 0)}, truth).query_recall);
  EXPECT_NE(recipe(truth).find("poses alone"), std::string::npos);
}

TEST(LoopEvaluation, WithoutPairsWhatIsFarApartIsFalseWhateverThePose) {
  LoopTruth truth = make_truth();
  truth.pairs.reset();
  const LoopRecord loop = accepted(truth, 30, 0);  // 300 m apart
  EXPECT_EQ(judgement(loop, truth), LoopJudgement::True);
  EXPECT_EQ(judgement(loop, truth, {.false_radius_m = 299.0}), LoopJudgement::FalsePair);
  EXPECT_EQ(judgement(loop, truth, {.false_radius_m = 301.0}), LoopJudgement::True);
}

TEST(LoopEvaluation, CountsPrecisionAndRecall) {
  const LoopTruth truth = make_truth();
  LoopRecord rejected = accepted(truth, 24, 0);
  rejected.verdict = "TooFewInliers";
  LoopRecord unscaled = accepted(truth, 21, 0);
  unscaled.has_scale = false;
  const LoopEvaluation result = evaluate_loops(
      {accepted(truth, 20, 0), unscaled, accepted(truth, 22, 0), accepted(truth, 30, 0), accepted(truth, 40, 0), rejected},
      truth);
  EXPECT_EQ(result.num_hypotheses, 6u);
  EXPECT_EQ(result.num_accepted, 5u);
  EXPECT_EQ(result.num_true, 2u);
  EXPECT_EQ(result.num_false, 1u);
  EXPECT_EQ(result.num_unjudged, 2u);
  EXPECT_EQ(result.num_with_scale, 3u) << "those without reference are not counted";
  EXPECT_DOUBLE_EQ(result.precision.value(), 2.0 / 3.0);
  // Queries 20 and 24 have pairs with overlap >= 0.3; only 20 was found.
  EXPECT_DOUBLE_EQ(result.query_recall.value(), 0.5);
  EXPECT_FALSE(evaluate_loops({}, truth).precision);
}

TEST(LoopEvaluation, TheRecipeStatesTheFigures) {
  const std::string text = recipe(make_truth());
  for (const char* figure : {"0.2", "15 inliers", "0.05", "within 10", "5 deg", "10 % of 60 m", "0.3"}) {
    EXPECT_NE(text.find(figure), std::string::npos) << figure;
  }
}

TEST(LoopEvaluation, AFrameBeyondTheTruthIsRefused) {
  const LoopTruth truth = make_truth();
  LoopRecord record = accepted(truth, 20, 0);
  record.query = 50;
  EXPECT_THROW(evaluate_loops({record}, truth), InputError);
}

}  // namespace
}  // namespace fabloop
