// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/earlier_flight.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "verification/loop_closer.h"

namespace fabloop {
namespace {

/// Whatever is asked is false.
GroundTruth nothing_in_common(std::size_t num_queries, std::size_t num_matches) {
  GroundTruth truth;
  truth.num_queries = num_queries;
  truth.num_matches = num_matches;
  truth.at = [](std::size_t, std::size_t) { return MatchTruth::False; };
  return truth;
}

}  // namespace

EarlierFlight look_at_earlier(const std::filesystem::path& folder, const FeatureOptions& features, int num_threads) {
  EarlierFlight earlier;
  if (folder.empty()) return earlier;
  earlier.sequence = read_sequence(folder, {.odometry = folder / "odometry.tum"});
  earlier.frames = describe_sequence(earlier.sequence, {.features = features, .num_threads = num_threads}).frames;
  std::erase_if(earlier.frames,
                [&](const DescribedFrame& frame) { return !earlier.sequence.frames[frame.frame].odom_from_camera; });
  if (earlier.frames.size() < 2) throw InputError(folder.string() + ": fewer than two images can be mapped");
  return earlier;
}

KeyframeMap keyframes_of(const EarlierFlight& earlier, const Model& model, int num_threads) {
  if (earlier.frames.empty()) return {};
  LoopCloserOptions options;
  options.num_threads = num_threads;
  options.propose = [](std::size_t) { return std::vector<Hypothesis>{}; };
  LoopCloser loop_closer(earlier.sequence.camera, model, options);
  for (const DescribedFrame& described : earlier.frames) {
    const Frame& frame = earlier.sequence.frames[described.frame];
    loop_closer.add_keyframe({.frame = described.frame,
                              .time_ns = frame.time_ns,
                              .odom_from_body = *frame.odom_from_camera,
                              .features = described.features});
  }
  return loop_closer.map();
}

std::vector<ScoredQuery> best_of_both_flights(const ScoreTable& scores, std::size_t num_earlier_places, std::size_t top) {
  std::vector<ScoredQuery> queries = scored_queries(scores, scores.place_frames.size());
  for (ScoredQuery& query : queries) {
    std::vector<ScoredMatch> best;
    std::size_t num_earlier = 0, num_own = 0;
    for (const ScoredMatch& match : query.matches) {
      std::size_t& num_taken = match.place < num_earlier_places ? num_earlier : num_own;
      if (num_taken++ < top) best.push_back(match);
    }
    query.matches = std::move(best);
  }
  return queries;
}

JudgedRun with_pairs_across(JudgedRun judged, const LedgerTable& ledger, const EarlierFlight& earlier) {
  const std::size_t num_earlier_frames = earlier.num_frames();
  for (QueryTruth& query : judged.queries) {
    query.frame += num_earlier_frames;
    query.num_false_pairs += earlier.frames.size();
  }
  for (JudgedHypothesis& hypothesis : judged.hypotheses) {
    hypothesis.query += num_earlier_frames;
    hypothesis.match += num_earlier_frames;
  }
  LedgerTable across{ledger.columns, {}};
  std::copy_if(ledger.rows.begin(), ledger.rows.end(), std::back_inserter(across.rows),
               [&](const LedgerRow& row) { return leads_into_earlier_map(ledger, row); });
  const JudgedRun of_across = judge_run(across, nothing_in_common(judged.queries.size(), num_earlier_frames), {});
  for (JudgedHypothesis hypothesis : of_across.hypotheses) {
    hypothesis.query += num_earlier_frames;
    judged.hypotheses.push_back(hypothesis);
  }
  std::stable_sort(judged.hypotheses.begin(), judged.hypotheses.end(),
                   [](const JudgedHypothesis& a, const JudgedHypothesis& b) { return a.query < b.query; });
  judged.has_consistency = judged.has_consistency || of_across.has_consistency;
  judged.recipe += "; all pairs with the " + std::to_string(earlier.frames.size()) + " places of the earlier flight are false";
  return judged;
}

}  // namespace fabloop
