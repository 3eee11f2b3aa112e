// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/fabmap/bootstrap.h"
#include "frontend/fabmap/calibration.h"
#include "frontend/fabmap/ground_truth.h"
#include "frontend/fabmap/precision_recall.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/run/ledger_table.h"

namespace fabloop {

/// The stages that a hypothesis passes, in their order. Each takes what the one before it let through.
enum class Stage {
  Appearance,   ///< Proposes pairs: the most probable places.
  Matching,     ///< Refuses pairs with too few features alike.
  Geometry,     ///< Refuses pairs without a proven relative pose.
  Consistency,  ///< Holds back loops that consecutive images do not confirm.
  BackEnd,      ///< Withdraws loops that the rest of the map contradicts.
};

/// "appearance", "matching", ...
std::string_view in_words(Stage stage);

/// How many of the stages a hypothesis with this verdict has passed, 1 to 5. Throws InputError for a name that is no verdict.
int num_stages_passed(const std::string& verdict);

/// A hypothesis, how far it came, and what it really is.
struct JudgedHypothesis {
  std::size_t query = 0, match = 0;
  int num_stages_passed = 1;
  double score = 0.0;                 ///< By appearance, whatever the method: higher is surer.
  std::optional<double> probability;  ///< By appearance; none where the method claims none.
  double num_matches = 0.0;
  std::optional<double> p_true;                ///< By geometry; none without a pose.
  MatchTruth place = MatchTruth::NotJudged;    ///< Whether the frames show one place.
  MatchTruth closure = MatchTruth::NotJudged;  ///< Whether they do and the pose is right; as `place` where there is no pose.
};

/// What could have been found from one frame, among the frames before it.
struct QueryTruth {
  std::size_t frame = 0;
  std::size_t num_true_pairs = 0, num_false_pairs = 0;
};

/// A run with its truth.
struct JudgedRun {
  std::vector<JudgedHypothesis> hypotheses;
  std::vector<QueryTruth> queries;  ///< One a frame.
  bool has_consistency = false;     ///< Whether that stage was on.
  std::string recipe;               ///< How pairs and poses were judged.
};

/// Judges every hypothesis: the place by `places`, the pose by `loops` where both frames have a reference. Without `loops.pairs`
/// a right pose also makes a place true that `places` does not judge. The consistency stage counts as on when any hypothesis is
/// Unconfirmed. Throws InputError for frames beyond the truth.
JudgedRun judge_run(const LedgerTable& ledger, const GroundTruth& places, const LoopTruth& loops,
                    const LoopEvaluationOptions& options = {});

struct StageOptions {
  BootstrapOptions bootstrap;                       ///< Over queries.
  std::vector<Stage> only{};                        ///< Which stages; empty: all that were on.
  std::size_t num_bins = 10;                        ///< Of the reliability diagrams.
  std::vector<std::size_t> recall_at = {1, 5, 10};  ///< The K of recall@K.
};

/// A figure and how far it may be off; none where it is not defined.
struct EstimatedFigure {
  std::optional<double> value;
  std::optional<Interval> interval;
};

/// What a stage let through, and how well its score sorts and tells the truth.
struct StageResult {
  Stage stage = Stage::Appearance;
  std::string_view score;  ///< What is thresholded: a column of `loops.csv`, or "score" where appearance claims no probability.
  std::size_t num_true_before = 0, num_false_before = 0;      ///< What came in. Appearance: all pairs of the sequence.
  std::size_t num_true = 0, num_false = 0, num_unjudged = 0;  ///< What passed.
  EstimatedFigure precision;                                  ///< True ones among those that passed.
  EstimatedFigure query_recall;               ///< Queries from which a true one passed, among those that have one.
  EstimatedFigure false_rejection;            ///< Refused among the false ones that came in.
  EstimatedFigure average_precision;          ///< Of the curve.
  EstimatedFigure recall_at_full_precision;   ///< Of the curve.
  std::optional<PrecisionRecallCurve> curve;  ///< Of each query's best (top-1); none where no query has a true match.
  std::vector<RecallAt> recall_at;
  std::optional<Calibration> calibration;  ///< Where the score claims to be a probability.
  EstimatedFigure expected_calibration_error, brier_score;
};

struct StageEvaluation {
  std::size_t num_queries = 0, num_queries_with_true_match = 0;
  std::vector<StageResult> stages;
  std::string recipe;  ///< Everything that a reader must know to compare the figures.
};

/// A figure of StageResult that has an interval.
struct StageFigure {
  std::string_view name;   ///< As in files: "query_recall".
  std::string_view title;  ///< For readers: "query recall".
  EstimatedFigure StageResult::*figure;
};

/// All of them, in the order of StageResult.
std::span<const StageFigure> stage_figures();

/// Takes away what a score sorts or claims (curve, average precision, recall at full precision and at K, calibration): for
/// hypotheses whose score says nothing. What passed stays.
void forget_ranking(StageResult& stage);

/// What each stage makes of a run.
StageEvaluation evaluate_stages(const JudgedRun& run, const StageOptions& options = {});

}  // namespace fabloop
