// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/features/feature_extractor.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"
#include "verification/neighbour.h"
#include "verification/verifier.h"
#include "verification/view.h"

namespace fabloop {

/// A frame of one of the sequences.
struct SurveyedFrame {
  std::size_t sequence = 0;
  std::size_t frame = 0;  ///< Position in its sequence.
  friend auto operator<=>(const SurveyedFrame&, const SurveyedFrame&) = default;
};

/// A pair to verify: the query is the later frame.
struct AskedPair {
  SurveyedFrame query, match;
  friend auto operator<=>(const AskedPair&, const AskedPair&) = default;
};

struct PairSurveyOptions {
  FeatureOptions features;
  VerifierOptions verifier;
  NeighbourOptions neighbour;      ///< Gives features a depth where a sequence has odometry.
  std::size_t num_neighbours = 3;  ///< As LoopCloserOptions.
  std::size_t max_neighbour_distance = 16;
  std::optional<std::vector<AskedPair>> only = {};  ///< These pairs, as far as both frames can be read. None: every pair.
  int num_threads = 0;                              ///< 0: all. The result does not depend on it.
  Warn warn;
  Progress progress;
};

/// A pair and what verification makes of it: the later frame is the query.
struct SurveyedPair {
  SurveyedFrame query, match;
  Verification verification;  ///< Without the inliers.
};

/// Verifies every pair of images inside the sequences and across them, not only those that look alike: what a geometric check
/// lets through and misses when nothing protects it. Pairs in the order of their frames.
std::vector<SurveyedPair> survey_pairs(const std::vector<Sequence>& sequences, const PairSurveyOptions& options = {});

/// Judges one pair, accepted or not, that has a pose; `truths` and `evaluations` by sequence. Across sequences every pair is of
/// two places.
JudgedLoop judge_pair(const SurveyedPair& pair, const std::vector<LoopTruth>& truths,
                      const std::vector<LoopEvaluationOptions>& evaluations);

/// How those of the surveyed pairs that have an overlap in [min_overlap, max_overlap) fare.
struct OverlapRecall {
  double min_overlap = 0;
  double max_overlap = 0;
  std::size_t num_pairs = 0;
  std::size_t num_found = 0;  ///< Accepted, and right.
};

/// What a survey says of one sequence, or of one pair of sequences.
struct SurveySummary {
  std::size_t query_sequence = 0, match_sequence = 0;
  std::size_t num_pairs = 0;
  std::size_t num_accepted = 0;
  std::size_t num_false = 0;  ///< Across sequences every accepted pair: they are taken to show different places.
  std::size_t num_unjudged = 0;
  OverlapRecall wide, narrow;  ///< Overlaps of 0.3 and more, and of 0.1 to 0.3.
};

/// One summary a sequence and one a pair of sequences; `truths` and `evaluations` (rules, height above ground) by sequence.
std::vector<SurveySummary> summarise_survey(const std::vector<SurveyedPair>& pairs, const std::vector<LoopTruth>& truths,
                                            const std::vector<LoopEvaluationOptions>& evaluations);

}  // namespace fabloop
