// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/precision_recall.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// A query whose matches were judged.
struct JudgedQuery {
  std::size_t num_true_places = 0;  ///< Among all that it could have been matched with.
  std::vector<Decision> decisions;  ///< The matches that are judged, the best first.
};

void require_frames(const std::vector<ScoredQuery>& queries, const PlaceFrames& places, const GroundTruth& truth) {
  const auto require = [](std::size_t frame, std::size_t num_frames, const char* what) {
    if (frame < num_frames) return;
    throw InputError("frame " + std::to_string(frame) + " is beyond the " + std::to_string(num_frames) + " " + what +
                     " of the truth; is it the truth of another sequence?");
  };
  for (const ScoredQuery& query : queries) require(query.frame, truth.num_queries, "queries");
  for (const auto& frames : places) {
    for (const std::size_t frame : frames) require(frame, truth.num_matches, "map frames");
  }
}

JudgedQuery judge(const ScoredQuery& query, const PlaceFrames& places, const GroundTruth& truth) {
  JudgedQuery judged;
  std::vector<MatchTruth> truths;
  truths.reserve(query.num_places);
  for (std::size_t place = 0; place < query.num_places; ++place) {
    truths.push_back(judge_place(truth, query.frame, places.at(place)));
    if (truths.back() == MatchTruth::True) ++judged.num_true_places;
  }
  std::vector<ScoredMatch> matches = query.matches;
  for (const ScoredMatch& match : matches) {
    if (std::isnan(match.score)) throw InputError("the score of query " + std::to_string(query.frame) + " is not a number");
  }
  std::stable_sort(matches.begin(), matches.end(), [](const ScoredMatch& a, const ScoredMatch& b) { return a.score > b.score; });
  for (const ScoredMatch& match : matches) {
    const MatchTruth is_true = truths.at(match.place);
    if (is_true != MatchTruth::NotJudged) judged.decisions.push_back({match.score, is_true == MatchTruth::True});
  }
  return judged;
}

double recall_at(const std::vector<JudgedQuery>& queries, std::size_t k, std::size_t num_wanted) {
  std::size_t num_found = 0;
  for (const JudgedQuery& query : queries) {
    const std::size_t end = std::min(k, query.decisions.size());
    num_found += std::any_of(query.decisions.begin(), query.decisions.begin() + static_cast<std::ptrdiff_t>(end),
                             [](const Decision& decision) { return decision.is_true; });
  }
  return static_cast<double>(num_found) / static_cast<double>(num_wanted);
}

std::string recipe_of(const PrecisionRecall& result, const GroundTruth& truth, const PrecisionRecallOptions& options,
                      std::size_t num_positives) {
  std::ostringstream text;
  text << truth.recipe << "; matches that are not judged are passed over; ";
  if (truth.within_one_sequence) text << "only earlier frames are matches; ";
  if (options.scored == Scored::BestOfQuery) {
    text << "scored: the best match of each query (top-1); recall is over the " << num_positives
         << " queries that have a true match";
  } else {
    text << "scored: every match given; recall is over the " << num_positives << " true pairs of query and place";
  }
  text << ", of " << result.num_queries << " queries";
  return text.str();
}

}  // namespace

PrecisionRecallCurve precision_recall_curve(std::vector<Decision> decisions, std::size_t num_positives) {
  if (num_positives == 0) throw InputError("there is no precision-recall curve where nothing could be true");
  for (const Decision& decision : decisions) {
    if (std::isnan(decision.score)) throw InputError("a score is not a number");
  }
  std::sort(decisions.begin(), decisions.end(), [](const Decision& a, const Decision& b) { return a.score > b.score; });
  PrecisionRecallCurve curve;
  curve.num_positives = num_positives;
  std::size_t num_true = 0;
  PrecisionRecallPoint last;
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    num_true += decisions[i].is_true;
    if (i + 1 < decisions.size() && decisions[i + 1].score == decisions[i].score) continue;
    PrecisionRecallPoint point{decisions[i].score, static_cast<double>(num_true) / static_cast<double>(i + 1),
                               static_cast<double>(num_true) / static_cast<double>(num_positives)};
    if (curve.points.empty()) last.precision = point.precision;
    curve.average_precision += (point.recall - last.recall) * point.precision;
    curve.area_trapezoidal += (point.recall - last.recall) * 0.5 * (point.precision + last.precision);
    if (num_true == i + 1) {
      curve.recall_at_full_precision = point.recall;
      curve.full_precision_threshold = point.threshold;
    }
    curve.points.push_back(last = point);
  }
  if (num_true > num_positives) {
    throw InputError(std::to_string(num_true) + " answers are true, but only " + std::to_string(num_positives) + " could be");
  }
  return curve;
}

MatchTruth judge_place(const GroundTruth& truth, std::size_t query, const std::vector<std::size_t>& frames) {
  MatchTruth result = MatchTruth::False;
  bool is_empty = true;
  for (const std::size_t frame : frames) {
    if (truth.within_one_sequence && frame >= query) break;
    is_empty = false;
    const MatchTruth match = truth.at(query, frame);
    if (match == MatchTruth::True) return match;
    if (match == MatchTruth::NotJudged) result = match;
  }
  return is_empty ? MatchTruth::NotJudged : result;
}

PrecisionRecall evaluate_recognition(const std::vector<ScoredQuery>& queries, const PlaceFrames& places, const GroundTruth& truth,
                                     const PrecisionRecallOptions& options) {
  require_frames(queries, places, truth);
  std::vector<JudgedQuery> judged;
  judged.reserve(queries.size());
  for (const ScoredQuery& query : queries) judged.push_back(judge(query, places, truth));

  PrecisionRecall result;
  result.num_queries = queries.size();
  std::size_t num_true_places = 0;
  std::vector<Decision> decisions;
  for (const JudgedQuery& query : judged) {
    result.num_queries_with_true_match += query.num_true_places > 0;
    num_true_places += query.num_true_places;
    const std::size_t wanted = options.scored == Scored::BestOfQuery ? 1 : query.decisions.size();
    decisions.insert(decisions.end(), query.decisions.begin(),
                     query.decisions.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, query.decisions.size())));
  }
  result.num_decisions = decisions.size();
  const std::size_t num_positives = options.scored == Scored::BestOfQuery ? result.num_queries_with_true_match : num_true_places;
  result.recipe = recipe_of(result, truth, options, num_positives);
  if (num_positives == 0) return result;
  result.curve = precision_recall_curve(std::move(decisions), num_positives);
  for (const std::size_t k : options.recall_at) {
    result.recall_at.push_back({k, recall_at(judged, k, result.num_queries_with_true_match)});
  }
  return result;
}

}  // namespace fabloop
