// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/stage_evaluation.h"

#include <algorithm>
#include <array>
#include <utility>

#include "frontend/error.h"
#include "verification/verdict.h"

namespace fabloop {
namespace {

constexpr int kLastVerdict = static_cast<int>(Verdict::ContradictsMap);

int stages_passed(Verdict verdict) {
  switch (verdict) {
    case Verdict::TooFewMatches:
      return 1;
    case Verdict::Unconfirmed:
      return 3;
    case Verdict::ContradictsMap:
      return 4;
    case Verdict::Accepted:
      return 5;
    default:
      return 2;
  }
}

bool knows_poses(const LoopTruth& truth) {
  return std::any_of(truth.world_from_camera.begin(), truth.world_from_camera.end(),
                     [](const auto& pose) { return pose.has_value(); });
}

/// A right relative pose proves that the frames show one place, where nothing else says so.
bool proves_place(const LedgerRow& row, MatchTruth place, const LoopTruth& truth, const LoopEvaluationOptions& options) {
  if (truth.pairs || place != MatchTruth::NotJudged || !row.loop.match_from_query) return false;
  const auto [first, second] = std::minmax(row.loop.query, row.loop.match);
  return second - first > options.exclusion_window && judge_loop(row.loop, truth, options).judgement == LoopJudgement::True;
}

/// Right only with both: the place and, where a pose can be judged, the pose.
MatchTruth judge_closure(const LedgerRow& row, MatchTruth place, const LoopTruth& truth, const LoopEvaluationOptions& options) {
  if (!row.loop.match_from_query || place == MatchTruth::False) return place;
  switch (judge_loop(row.loop, truth, options).judgement) {
    case LoopJudgement::FalsePair:
    case LoopJudgement::FalsePose:
      return MatchTruth::False;
    case LoopJudgement::True:
    case LoopJudgement::NoReference:
    case LoopJudgement::UnclearPair:
      return place;
  }
  return place;
}

std::vector<QueryTruth> query_truths(const GroundTruth& truth) {
  std::vector<QueryTruth> queries;
  for (std::size_t query = 0; query < truth.num_queries; ++query) {
    QueryTruth counts;
    counts.frame = query;
    for (std::size_t match = 0; match < std::min(query, truth.num_matches); ++match) {
      const MatchTruth is_true = truth.at(query, match);
      counts.num_true_pairs += is_true == MatchTruth::True;
      counts.num_false_pairs += is_true == MatchTruth::False;
    }
    queries.push_back(counts);
  }
  return queries;
}

}  // namespace

std::string_view in_words(Stage stage) {
  constexpr std::array<std::string_view, 5> kNames = {"appearance", "matching", "geometry", "consistency", "back end"};
  return kNames.at(static_cast<std::size_t>(stage));
}

int num_stages_passed(const std::string& verdict) {
  for (int i = 0; i <= kLastVerdict; ++i) {
    if (verdict == to_string(static_cast<Verdict>(i))) return stages_passed(static_cast<Verdict>(i));
  }
  if (verdict == "accepted") return stages_passed(Verdict::Accepted);
  throw InputError("'" + verdict + "' is no verdict; give loops.csv of a run of this version");
}

std::span<const StageFigure> stage_figures() {
  static constexpr std::array<StageFigure, 7> kFigures = {
      {{"precision", "precision", &StageResult::precision},
       {"query_recall", "query recall", &StageResult::query_recall},
       {"false_rejection", "false refused", &StageResult::false_rejection},
       {"average_precision", "average prec.", &StageResult::average_precision},
       {"recall_at_full_precision", "recall@100%", &StageResult::recall_at_full_precision},
       {"expected_calibration_error", "ECE", &StageResult::expected_calibration_error},
       {"brier_score", "Brier", &StageResult::brier_score}}};
  return kFigures;
}

void forget_ranking(StageResult& stage) {
  stage.average_precision = stage.recall_at_full_precision = {};
  stage.expected_calibration_error = stage.brier_score = {};
  stage.curve.reset();
  stage.recall_at.clear();
  stage.calibration.reset();
}

JudgedRun judge_run(const LedgerTable& ledger, const GroundTruth& places, const LoopTruth& loops,
                    const LoopEvaluationOptions& options) {
  JudgedRun run;
  run.recipe = places.recipe + "; from geometry on, " + (loops.pairs ? pose_recipe(options) : recipe(loops, options));
  if (!loops.pairs && knows_poses(loops)) {
    run.recipe +=
        "; a right pose makes a pair true that is not judged by these rules, so that recall is of what these rules or this run "
        "know";
  }
  run.queries = query_truths(places);
  for (const LedgerRow& row : ledger.rows) {
    const auto& [query, match] = std::pair(row.loop.query, row.loop.match);
    if (query >= places.num_queries || match >= places.num_matches) {
      throw InputError("loops.csv: frame " + std::to_string(std::max(query, match)) + " is beyond the " +
                       std::to_string(places.num_queries) + " of the truth; is it the truth of another sequence?");
    }
    JudgedHypothesis judged;
    judged.query = query;
    judged.match = match;
    judged.num_stages_passed = num_stages_passed(row.loop.verdict);
    // A normalised sum may exceed one by its rounding.
    judged.score = std::min(1.0, ledger.figure(row, "probability").value_or(0.0));
    judged.probability = judged.score;
    judged.num_matches = ledger.figure(row, "matches").value_or(0.0);
    if (row.loop.match_from_query) judged.p_true = ledger.figure(row, "p_true");
    judged.place = places.at(query, match);
    if (proves_place(row, judged.place, loops, options)) {
      judged.place = MatchTruth::True;
      ++run.queries[query].num_true_pairs;
    }
    judged.closure = judge_closure(row, judged.place, loops, options);
    run.has_consistency = run.has_consistency || row.loop.verdict == to_string(Verdict::Unconfirmed);
    run.hypotheses.push_back(judged);
  }
  return run;
}

}  // namespace fabloop
