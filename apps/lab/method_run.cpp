// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/method_run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "frontend/error.h"
#include "posegraph/run/run_folder.h"

namespace fabloop {
namespace {

using FramePair = std::pair<std::size_t, std::size_t>;  // query, match

/// Stages that a loop has passed when it comes to the back end.
constexpr int kBeforeBackEnd = 4;

LoopEvaluationOptions evaluation_of(const LabCell& cell) {
  LoopEvaluationOptions options;
  options.height_above_ground_m = cell.height_above_ground_m;
  options.exclusion_window = static_cast<std::size_t>(cell.settings.window);
  options.false_radius_m = false_radius_m({}, cell.height_above_ground_m);
  return options;
}

double probability_of(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

/// What the method proposes, by query.
class Proposals {
 public:
  Proposals(const LabMethod& method, const ScoreTable& scores, std::size_t num_earlier_places, std::size_t top)
      : claims_probability_(method.method && is_probabilistic(*method.method)),
        num_earlier_places_(num_earlier_places),
        queries_(best_of_both_flights(scores, num_earlier_places, top)) {
    for (const ScoredQuery& query : queries_) {
      for (const ScoredMatch& match : query.matches) score_of_[{query.frame, scores.place_frames[match.place]}] = match.score;
    }
  }

  /// For the loop closer, of the keyframe at that position of its map. A score that is no probability says nothing for or against
  /// the place.
  std::vector<Hypothesis> of(std::size_t position) const {
    constexpr double kUnknown = 0.5;
    std::vector<Hypothesis> hypotheses;
    for (const ScoredMatch& match : queries_.at(position - num_earlier_places_).matches) {
      hypotheses.push_back(
          {static_cast<PlaceId>(match.place), claims_probability_ ? probability_of(match.score) : kUnknown, match.score});
    }
    return hypotheses;
  }

  const std::vector<ScoredQuery>& queries() const { return queries_; }

  void put_scores(JudgedHypothesis& hypothesis) const {
    hypothesis.score = score_of_.at({hypothesis.query, hypothesis.match});
    hypothesis.probability = claims_probability_ ? std::optional(probability_of(hypothesis.score)) : std::nullopt;
  }

 private:
  bool claims_probability_;
  std::size_t num_earlier_places_;
  std::vector<ScoredQuery> queries_;
  std::map<FramePair, double> score_of_;
};

MapperOptions mapper_options(const LabCell& cell, int num_threads) {
  MapperOptions options;
  options.loops.num_threads = num_threads;
  options.loops.verifier.seed = 1;
  options.loops.verifier.min_inliers = static_cast<int>(cell.settings.min_inliers);
  options.loops.consistency.num_required = static_cast<std::size_t>(cell.settings.consistency);
  return options;
}

/// Maps the frames with the method's proposals; no loop is withdrawn.
Map map_with(const Proposals& proposals, const CellData& data, MapperOptions options) {
  options.loops.propose = [&](std::size_t current) { return proposals.of(current); };
  options.max_loop_surprise = 1.0;
  Mapper mapper(data.sequence.camera, data.model, options, data.earlier_map);
  for (const DescribedFrame& frame : data.frames) mapper.process(data.sequence.frames[frame.frame], frame);
  return mapper.finish();
}

/// Whether two frames show one place, numbered as EarlierFlight says.
MatchTruth truth_of(const CellData& data, std::size_t query, std::size_t match) {
  const std::size_t num_earlier = data.earlier.num_frames();
  return match < num_earlier ? MatchTruth::False : data.places.at(query - num_earlier, match - num_earlier);
}

/// The proposals alone, none of them looked at.
void add_unverified(const Proposals& proposals, const ScoreTable& scores, const CellData& data, JudgedRun& run) {
  for (const ScoredQuery& query : proposals.queries()) {
    for (const ScoredMatch& match : query.matches) {
      JudgedHypothesis hypothesis;
      hypothesis.query = query.frame;
      hypothesis.match = scores.place_frames[match.place];
      hypothesis.place = hypothesis.closure = truth_of(data, hypothesis.query, hypothesis.match);
      run.hypotheses.push_back(hypothesis);
    }
  }
}

LedgerTable without_pairs_across(const LedgerTable& ledger) {
  LedgerTable within = ledger;
  std::erase_if(within.rows, [&](const LedgerRow& row) { return leads_into_earlier_map(ledger, row); });
  return within;
}

/// The ledger of a map, judged.
JudgedRun judge_map(const Map& map, const CellData& data, const LoopEvaluationOptions& evaluation,
                    const std::filesystem::path& scratch) {
  const std::filesystem::path file = scratch / "loops.csv";
  write_loops_csv(file, map);
  const LedgerTable ledger = read_ledger(file, LedgerRows::All);
  std::filesystem::remove(file);
  JudgedRun run = judge_run(without_pairs_across(ledger), data.places, data.loops, evaluation);
  // No back end has spoken yet.
  for (JudgedHypothesis& hypothesis : run.hypotheses)
    hypothesis.num_stages_passed = std::min(hypothesis.num_stages_passed, kBeforeBackEnd);
  return data.earlier.num_frames() > 0 ? with_pairs_across(std::move(run), ledger, data.earlier) : run;
}

}  // namespace

MethodResult run_method(const LabMethod& method, const ScoreTable& scores, const CellData& data, const LabCell& cell,
                        const LabDescription& description, const std::filesystem::path& scratch, int num_threads) {
  const Proposals proposals(method, scores, data.earlier.frames.size(), static_cast<std::size_t>(cell.settings.top));
  const LoopEvaluationOptions evaluation = evaluation_of(cell);
  MethodResult result{method.name, scores.label, {}, {}};
  if (!description.verifies()) {
    result.run = judge_run({}, data.places, data.loops, evaluation);
    if (data.earlier.num_frames() > 0) result.run = with_pairs_across(std::move(result.run), {}, data.earlier);
    add_unverified(proposals, scores, data, result.run);
  } else {
    const MapperOptions options = mapper_options(cell, num_threads);
    const Map map = map_with(proposals, data, options);
    result.run = judge_map(map, data, evaluation, scratch);
    result.back_ends = try_back_ends(description.back_ends,
                                     {map, data.loops, data.reference, data.frame_times_ns, evaluation, options, cell.settings});
    for (BackEndTrial& trial : result.back_ends) {
      for (TriedLoop& loop : trial.loops) {
        loop.query += data.earlier.num_frames();
        loop.match += data.earlier.num_frames();
      }
    }
  }
  result.run.has_consistency = cell.settings.consistency > 0.0;
  for (JudgedHypothesis& hypothesis : result.run.hypotheses) proposals.put_scores(hypothesis);
  return result;
}

JudgedRun with_back_end(const JudgedRun& run, const BackEndTrial& trial) {
  JudgedRun judged = run;
  std::map<FramePair, bool> is_kept;
  for (const TriedLoop& loop : trial.loops) {
    if (!loop.is_injected) is_kept[{loop.query, loop.match}] = loop.is_kept;
  }
  for (JudgedHypothesis& hypothesis : judged.hypotheses) {
    const auto found = is_kept.find({hypothesis.query, hypothesis.match});
    if (hypothesis.num_stages_passed == kBeforeBackEnd && found != is_kept.end()) hypothesis.num_stages_passed += found->second;
  }
  for (const TriedLoop& loop : trial.loops) {
    if (!loop.is_injected) continue;
    JudgedHypothesis injected;
    injected.query = loop.query;
    injected.match = loop.match;
    injected.num_stages_passed = kBeforeBackEnd + (loop.is_kept ? 1 : 0);
    injected.place = injected.closure = loop.truth;
    judged.hypotheses.push_back(injected);
  }
  return judged;
}

JudgedRun pooled(const std::vector<const JudgedRun*>& runs) {
  JudgedRun all;
  std::size_t first_frame = 0;
  for (const JudgedRun* run : runs) {
    if (all.recipe.empty()) all.recipe = run->recipe;
    all.has_consistency = all.has_consistency || run->has_consistency;
    std::size_t num_frames = 0;
    for (QueryTruth query : run->queries) {
      num_frames = std::max(num_frames, query.frame + 1);
      query.frame += first_frame;
      all.queries.push_back(query);
    }
    for (JudgedHypothesis hypothesis : run->hypotheses) {
      hypothesis.query += first_frame;
      hypothesis.match += first_frame;
      all.hypotheses.push_back(hypothesis);
    }
    first_frame += num_frames;
  }
  return all;
}

}  // namespace fabloop
