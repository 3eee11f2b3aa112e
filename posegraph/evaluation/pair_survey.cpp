// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/pair_survey.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "frontend/parallel.h"
#include "posegraph/describe_sequence.h"
#include "verification/map/keyframe_map.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

constexpr double kWideOverlap = 0.3;
constexpr double kNarrowOverlap = 0.1;

struct SurveyedView {
  std::size_t sequence = 0;
  View view;
};

SurveyedFrame frame_of(const SurveyedView& surveyed) { return {surveyed.sequence, surveyed.view.frame}; }

/// What the odometry says of the way between two views, over those between them.
UncertainPose odometry_of(std::size_t earlier, std::size_t current, const std::vector<View>& views, const Sequence& sequence) {
  UncertainPose earlier_from_view;
  Pose world_from_last = *sequence.frames[views[earlier].frame].odom_from_camera;
  for (std::size_t i = earlier + 1; i <= current; ++i) {
    const auto& world_from_view = sequence.frames[views[i].frame].odom_from_camera;
    if (!world_from_view) continue;
    earlier_from_view = earlier_from_view * uncertain_step(world_from_last.inverse() * *world_from_view);
    world_from_last = *world_from_view;
  }
  return earlier_from_view;
}

/// The neighbours of one view, as LoopCloser sees them keyframe by keyframe; RecentNeighbour::recent is the view's index.
std::vector<RecentNeighbour> neighbours_of(std::size_t current, const std::vector<View>& views, const Sequence& sequence,
                                           const PairSurveyOptions& options) {
  const auto& world_from_current = sequence.frames[views[current].frame].odom_from_camera;
  if (!world_from_current) return {};
  std::vector<RecentView> recent;
  std::vector<std::size_t> indices;
  for (std::size_t distance = 1; distance <= options.max_neighbour_distance && distance <= current; distance *= 2) {
    const View& earlier = views[current - distance];
    const auto& world_from_earlier = sequence.frames[earlier.frame].odom_from_camera;
    if (!world_from_earlier) continue;
    const UncertainPose odometry = odometry_of(current - distance, current, views, sequence);
    recent.push_back({&earlier, odometry.pose, relative_distance_sigma(odometry)});
    indices.push_back(current - distance);
  }
  NeighbourOptions neighbour = options.neighbour;
  neighbour.seed = options.verifier.seed;
  auto found = see_recent(recent, views[current], options.num_neighbours, neighbour);
  for (RecentNeighbour& f : found) f.recent = indices[f.recent];
  return found;
}

/// Depths from neighbours.
void link_neighbours_of(std::vector<View>& views, const Sequence& sequence, const PairSurveyOptions& options) {
  std::vector<std::vector<RecentNeighbour>> neighbours(views.size());
  parallel_for(views.size(), options.num_threads,
               [&](std::size_t current) { neighbours[current] = neighbours_of(current, views, sequence, options); });
  for (std::size_t current = 0; current < views.size(); ++current) {
    for (const RecentNeighbour& n : neighbours[current]) give_depths(views[n.recent], views[current], n);
  }
}

/// Frames of a sequence that follow one another: from the first to before the last.
struct FrameRange {
  std::size_t first = 0, last = 0;
};

/// The frames of a sequence that must be seen: all, or those of the pairs that are asked for with all that may give them depth.
std::vector<FrameRange> needed_frames(std::size_t sequence, std::size_t num_frames, const PairSurveyOptions& options) {
  if (!options.only) return {{0, num_frames}};
  std::set<std::size_t> asked;
  for (const AskedPair& pair : *options.only) {
    for (const SurveyedFrame& frame : {pair.query, pair.match}) {
      if (frame.sequence == sequence) asked.insert(frame.frame);
    }
  }
  const std::size_t reach = options.max_neighbour_distance;
  std::vector<FrameRange> ranges;
  for (const std::size_t frame : asked) {
    const std::size_t first = frame - std::min(frame, reach);
    const std::size_t last = std::min(num_frames, frame + reach + 1);
    if (!ranges.empty() && first <= ranges.back().last) {
      ranges.back().last = last;
    } else {
      ranges.push_back({first, last});
    }
  }
  return ranges;
}

std::vector<SurveyedView> views_of(const std::vector<Sequence>& sequences, const PairSurveyOptions& options) {
  std::vector<SurveyedView> all;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    for (const FrameRange& range : needed_frames(s, sequences[s].frames.size(), options)) {
      Sequence part = sequences[s];
      part.frames.assign(sequences[s].frames.begin() + static_cast<std::ptrdiff_t>(range.first),
                         sequences[s].frames.begin() + static_cast<std::ptrdiff_t>(range.last));
      DescribedSequence described =
          describe_sequence(part, {options.features, IfDamaged::Skip, options.num_threads, options.warn, options.progress});
      std::vector<View> views;
      for (DescribedFrame& frame : described.frames)
        views.push_back(make_view(range.first + frame.frame, part.camera, std::move(frame.features)));
      link_neighbours_of(views, sequences[s], options);
      for (View& view : views) all.push_back({s, std::move(view)});
    }
  }
  return all;
}

LoopRecord record_of(const SurveyedPair& pair) {
  const Verification& verification = pair.verification;
  return {pair.query.frame, pair.match.frame, std::string(to_string(verification.verdict)), verification.has_scale,
          verification.match_from_query};
}

/// Of the surveyed pairs.
OverlapRecall recall(double min_overlap, double max_overlap, const std::vector<LoopRecord>& records, const LoopTruth& truth,
                     const LoopEvaluation& evaluation) {
  std::set<std::pair<std::size_t, std::size_t>> right;
  for (const JudgedLoop& loop : evaluation.loops) {
    const bool wrong = loop.judgement == LoopJudgement::FalsePair || loop.judgement == LoopJudgement::FalsePose;
    if (!wrong) right.insert(std::minmax(loop.query, loop.match));
  }
  OverlapRecall result{min_overlap, max_overlap};
  for (const LoopRecord& record : records) {
    const auto known = truth.pairs->find(std::minmax(record.query, record.match));
    if (known == truth.pairs->end()) continue;
    if (known->second.overlap < min_overlap || known->second.overlap >= max_overlap) continue;
    ++result.num_pairs;
    result.num_found += right.count(known->first);
  }
  return result;
}

}  // namespace

std::vector<SurveyedPair> survey_pairs(const std::vector<Sequence>& sequences, const PairSurveyOptions& options) {
  const std::vector<SurveyedView> views = views_of(sequences, options);
  const Verifier verifier(options.verifier);
  const std::set<AskedPair> only =
      options.only ? std::set<AskedPair>(options.only->begin(), options.only->end()) : std::set<AskedPair>();
  const auto is_asked = [&](const SurveyedView& query, const SurveyedView& match) {
    return !options.only || only.count({frame_of(query), frame_of(match)}) > 0;
  };
  const std::size_t num_pairs = options.only ? only.size() : views.size() * (views.size() - 1) / 2;
  std::vector<std::vector<SurveyedPair>> rows(views.size());
  std::mutex progress_mutex;
  std::size_t num_done = 0;
  parallel_for(views.size(), options.num_threads, [&](std::size_t q) {
    for (std::size_t m = 0; m < q; ++m) {
      if (!is_asked(views[q], views[m])) continue;
      SurveyedPair pair{frame_of(views[q]), frame_of(views[m]), verifier.verify(views[q].view, views[m].view)};
      pair.verification.inliers = {};
      rows[q].push_back(std::move(pair));
    }
    const std::lock_guard lock(progress_mutex);
    num_done += rows[q].size();
    if (options.progress) options.progress("pairs", num_done, num_pairs);
  });
  std::vector<SurveyedPair> pairs;
  for (auto& row : rows) std::move(row.begin(), row.end(), std::back_inserter(pairs));
  return pairs;
}

JudgedLoop judge_pair(const SurveyedPair& pair, const std::vector<LoopTruth>& truths,
                      const std::vector<LoopEvaluationOptions>& evaluations) {
  const std::size_t sequence = pair.query.sequence;
  if (sequence != pair.match.sequence) return {pair.query.frame, pair.match.frame, LoopJudgement::FalsePair};
  return judge_loop(record_of(pair), truths[sequence], evaluations[sequence]);
}

std::vector<SurveySummary> summarise_survey(const std::vector<SurveyedPair>& pairs, const std::vector<LoopTruth>& truths,
                                            const std::vector<LoopEvaluationOptions>& evaluations) {
  std::vector<SurveySummary> summaries;
  for (std::size_t q = 0; q < truths.size(); ++q) {
    for (std::size_t m = 0; m <= q; ++m) {
      SurveySummary summary;
      summary.query_sequence = q;
      summary.match_sequence = m;
      std::vector<LoopRecord> records;
      for (const SurveyedPair& pair : pairs) {
        if (pair.query.sequence != q || pair.match.sequence != m) continue;
        ++summary.num_pairs;
        records.push_back(record_of(pair));
      }
      if (q == m) {
        const LoopEvaluation evaluation = evaluate_loops(records, truths[q], evaluations[q]);
        summary.num_accepted = evaluation.num_accepted;
        summary.num_false = evaluation.num_false;
        summary.num_unjudged = evaluation.num_unjudged;
        if (truths[q].pairs) {
          summary.wide = recall(kWideOverlap, std::numeric_limits<double>::infinity(), records, truths[q], evaluation);
          summary.narrow = recall(kNarrowOverlap, kWideOverlap, records, truths[q], evaluation);
        }
      } else {
        for (const LoopRecord& record : records) summary.num_accepted += record.accepted();
        summary.num_false = summary.num_accepted;
      }
      summaries.push_back(summary);
    }
  }
  return summaries;
}

}  // namespace fabloop
