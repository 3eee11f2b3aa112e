// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <span>
#include <sstream>
#include <unordered_map>

#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop {
namespace {

/// What one query brings to the figures of one stage.
struct QueryTally {
  std::size_t num_true_before = 0, num_false_before = 0;
  std::size_t num_true = 0, num_false = 0, num_unjudged = 0;
  bool is_wanted = false;           ///< It has a true match.
  std::vector<Decision> decisions;  ///< Judged ones that passed, the best first.
  std::vector<Decision> claims;     ///< Probabilities to compare with the truth.
};

struct StageRules {
  Stage stage;
  int num_passed;  ///< Hypotheses that passed so many stages have passed this one.
  std::string_view score;
};

MatchTruth truth_at(Stage stage, const JudgedHypothesis& hypothesis) {
  return stage == Stage::Appearance || stage == Stage::Matching ? hypothesis.place : hypothesis.closure;
}

double score_at(Stage stage, const JudgedHypothesis& hypothesis) {
  if (stage == Stage::Appearance) return hypothesis.score;
  if (stage == Stage::Matching) return hypothesis.num_matches;
  return hypothesis.p_true.value_or(0.0);
}

/// The probability that the stage claims, before it decides. The stages after geometry make no new claim: theirs is geometry's,
/// of what they let through.
std::optional<double> claim_at(const StageRules& rules, const JudgedHypothesis& hypothesis) {
  if (rules.stage == Stage::Appearance) return hypothesis.probability;
  if (rules.stage == Stage::Matching) return std::nullopt;
  const bool is_asked = rules.stage == Stage::Geometry || hypothesis.num_stages_passed >= rules.num_passed;
  return is_asked ? hypothesis.p_true : std::nullopt;
}

void count(const StageRules& rules, int num_passed_before, const JudgedHypothesis& hypothesis, QueryTally& tally) {
  const MatchTruth is_true = truth_at(rules.stage, hypothesis);
  const bool is_judged = is_true != MatchTruth::NotJudged;
  if (is_judged) {
    if (const auto claim = claim_at(rules, hypothesis)) tally.claims.push_back({*claim, is_true == MatchTruth::True});
  }
  if (rules.stage != Stage::Appearance && hypothesis.num_stages_passed >= num_passed_before) {
    tally.num_true_before += is_true == MatchTruth::True;
    tally.num_false_before += is_true == MatchTruth::False;
  }
  if (hypothesis.num_stages_passed < rules.num_passed) return;
  tally.num_true += is_true == MatchTruth::True;
  tally.num_false += is_true == MatchTruth::False;
  tally.num_unjudged += !is_judged;
  if (is_judged) tally.decisions.push_back({score_at(rules.stage, hypothesis), is_true == MatchTruth::True});
}

std::vector<QueryTally> tally_queries(const JudgedRun& run, const StageRules& rules, int num_passed_before) {
  std::vector<QueryTally> tallies(run.queries.size());
  std::unordered_map<std::size_t, std::size_t> position_of_frame;
  for (std::size_t i = 0; i < run.queries.size(); ++i) {
    position_of_frame[run.queries[i].frame] = i;
    tallies[i].is_wanted = run.queries[i].num_true_pairs > 0;
    if (rules.stage != Stage::Appearance) continue;
    tallies[i].num_true_before = run.queries[i].num_true_pairs;
    tallies[i].num_false_before = run.queries[i].num_false_pairs;
  }
  for (const JudgedHypothesis& hypothesis : run.hypotheses) {
    count(rules, num_passed_before, hypothesis, tallies[position_of_frame.at(hypothesis.query)]);
  }
  for (QueryTally& tally : tallies) {
    std::stable_sort(tally.decisions.begin(), tally.decisions.end(),
                     [](const Decision& a, const Decision& b) { return a.score > b.score; });
  }
  return tallies;
}

std::optional<double> ratio(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// All figures of some queries, which may be named more than once.
struct Figures {
  QueryTally sum;
  std::size_t num_wanted = 0;
  std::vector<std::size_t> num_found_at;  ///< Wanted queries with a true one among their K best.
  std::optional<PrecisionRecallCurve> curve;
  std::optional<Calibration> calibration;
  std::vector<std::optional<double>> values;
};

Figures figures_of(const std::vector<QueryTally>& tallies, std::span<const std::size_t> sample, const StageOptions& options) {
  Figures figures;
  figures.num_found_at.resize(options.recall_at.size());
  std::vector<Decision> best;
  std::size_t num_found = 0;
  for (const std::size_t i : sample) {
    const QueryTally& tally = tallies[i];
    figures.sum.num_true_before += tally.num_true_before;
    figures.sum.num_false_before += tally.num_false_before;
    figures.sum.num_true += tally.num_true;
    figures.sum.num_false += tally.num_false;
    figures.sum.num_unjudged += tally.num_unjudged;
    figures.sum.claims.insert(figures.sum.claims.end(), tally.claims.begin(), tally.claims.end());
    figures.num_wanted += tally.is_wanted;
    num_found += tally.num_true > 0 && tally.is_wanted;
    if (!tally.decisions.empty()) best.push_back(tally.decisions.front());
    const auto first_true = std::find_if(tally.decisions.begin(), tally.decisions.end(), [](const auto& d) { return d.is_true; });
    const auto rank = static_cast<std::size_t>(first_true - tally.decisions.begin());
    for (std::size_t k = 0; k < options.recall_at.size(); ++k) {
      figures.num_found_at[k] += first_true != tally.decisions.end() && rank < options.recall_at[k];
    }
  }
  if (figures.num_wanted > 0) figures.curve = precision_recall_curve(std::move(best), figures.num_wanted);
  if (!figures.sum.claims.empty()) figures.calibration = calibration(figures.sum.claims, options.num_bins);
  const auto of_curve = [&](auto member) { return figures.curve ? std::optional(member(*figures.curve)) : std::nullopt; };
  const auto of_claims = [&](auto member) {
    return figures.calibration ? std::optional(member(*figures.calibration)) : std::nullopt;
  };
  const std::size_t num_refused = figures.sum.num_false_before - std::min(figures.sum.num_false_before, figures.sum.num_false);
  figures.values = {ratio(figures.sum.num_true, figures.sum.num_true + figures.sum.num_false),
                    ratio(num_found, figures.num_wanted),
                    ratio(num_refused, figures.sum.num_false_before),
                    of_curve([](const PrecisionRecallCurve& c) { return c.average_precision; }),
                    of_curve([](const PrecisionRecallCurve& c) { return c.recall_at_full_precision; }),
                    of_claims([](const Calibration& c) { return c.expected_calibration_error; }),
                    of_claims([](const Calibration& c) { return c.brier_score; })};
  return figures;
}

bool claims_probability(const JudgedRun& run) {
  return std::all_of(run.hypotheses.begin(), run.hypotheses.end(),
                     [](const JudgedHypothesis& hypothesis) { return hypothesis.probability.has_value(); });
}

StageResult result_of(const StageRules& rules, const std::vector<QueryTally>& tallies, const StageOptions& options) {
  std::vector<std::size_t> all(tallies.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  Figures figures = figures_of(tallies, all, options);
  const auto intervals = bootstrap_intervals(
      tallies.size(), [&](std::span<const std::size_t> sample) { return figures_of(tallies, sample, options).values; },
      options.bootstrap);
  const auto figure = [&](std::size_t i) {
    return EstimatedFigure{figures.values[i], i < intervals.size() ? intervals[i] : std::nullopt};
  };
  StageResult result;
  result.stage = rules.stage;
  result.score = rules.score;
  result.num_true_before = figures.sum.num_true_before;
  result.num_false_before = figures.sum.num_false_before;
  result.num_true = figures.sum.num_true;
  result.num_false = figures.sum.num_false;
  result.num_unjudged = figures.sum.num_unjudged;
  result.precision = figure(0);
  result.query_recall = figure(1);
  result.false_rejection = figure(2);
  result.average_precision = figure(3);
  result.recall_at_full_precision = figure(4);
  result.expected_calibration_error = figure(5);
  result.brier_score = figure(6);
  for (std::size_t k = 0; figures.num_wanted > 0 && k < options.recall_at.size(); ++k) {
    result.recall_at.push_back({options.recall_at[k], *ratio(figures.num_found_at[k], figures.num_wanted)});
  }
  result.curve = std::move(figures.curve);
  result.calibration = std::move(figures.calibration);
  return result;
}

std::string recipe_of(const StageEvaluation& evaluation, const JudgedRun& run, const StageOptions& options) {
  std::ostringstream text;
  text << run.recipe << "; pairs that are not judged are passed over; only earlier frames are matches; curves score each query's "
       << "best (top-1), recall is over the " << evaluation.num_queries_with_true_match << " queries that have a true match, of "
       << evaluation.num_queries
       << "; a stage's false rejection is over the false pairs that came to it (appearance: over all false pairs of the "
          "sequence); "
       << "calibration in " << options.num_bins << " bins, of appearance over all hypotheses, of geometry over all with a pose, "
       << "later over what passed";
  if (options.bootstrap.num_resamples > 0) {
    text << "; intervals: " << 100.0 * options.bootstrap.confidence << " %, bootstrap over queries, "
         << options.bootstrap.num_resamples << " resamples, seed " << options.bootstrap.seed
         << " (consecutive queries are alike, so they are rather too narrow)";
  }
  return text.str();
}

}  // namespace

StageEvaluation evaluate_stages(const JudgedRun& run, const StageOptions& options) {
  StageEvaluation evaluation;
  evaluation.num_queries = run.queries.size();
  for (const QueryTruth& query : run.queries) evaluation.num_queries_with_true_match += query.num_true_pairs > 0;
  int num_passed_before = 0;
  for (const StageRules& rules : {StageRules{Stage::Appearance, 1, claims_probability(run) ? "probability" : "score"},
                                  StageRules{Stage::Matching, 2, "matches"}, StageRules{Stage::Geometry, 3, "p_true"},
                                  StageRules{Stage::Consistency, 4, "p_true"}, StageRules{Stage::BackEnd, 5, "p_true"}}) {
    if (rules.stage == Stage::Consistency && !run.has_consistency) continue;
    const bool is_wanted =
        options.only.empty() || std::find(options.only.begin(), options.only.end(), rules.stage) != options.only.end();
    if (is_wanted) evaluation.stages.push_back(result_of(rules, tally_queries(run, rules, num_passed_before), options));
    num_passed_before = rules.num_passed;
  }
  evaluation.recipe = recipe_of(evaluation, run, options);
  return evaluation;
}

}  // namespace fabloop
