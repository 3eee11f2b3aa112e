// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/view_graph.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "frontend/features/spatially_even.h"
#include "frontend/parallel.h"
#include "posegraph/sfm/kept_work.h"
#include "verification/evidence.h"
#include "verification/matching/match_consistency.h"
#include "verification/matching/similar_group.h"
#include "verification/pair_seed.h"
#include "verification/pose/planar_ambiguity.h"
#include "verification/pose/ray_pairs.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {
namespace {

bool is_worth_a_closer_look(const Features& query, const Features& match, const ViewGraphOptions& options) {
  if (options.num_first_features == 0) return true;
  const Features first_query = first_features(query, options.num_first_features);
  const Features first_match = first_features(match, options.num_first_features);
  const std::vector<Match> matches = match_features(first_query, first_match, options.matching);
  return largest_similar_group(first_query, first_match, matches) >= options.min_first_group;
}

/// Whether accidental matches could give as many inliers.
bool is_proven(const View& query, const View& match, const std::vector<Match>& matches, const std::vector<Match>& inliers,
               const ViewGraphOptions& options) {
  constexpr double kFivePointModels = 10;
  const double p_accident = p_accidental_epipolar_match(match, options.max_error_px);
  const ViewChange change = view_change(query.features, match.features, matches);
  const auto consistent = [&](const std::vector<Match>& of) {
    return static_cast<std::size_t>(std::count_if(
        of.begin(), of.end(), [&](const Match& m) { return agrees_with(change, query.features, match.features, m); }));
  };
  const double of_all = log10_false_alarms(matches.size(), inliers.size(), 5, p_accident, kFivePointModels);
  const double of_consistent = log10_false_alarms(consistent(matches), consistent(inliers), 5, p_accident, kFivePointModels);
  return std::min(of_all, of_consistent) <= options.max_log10_false_alarms;
}

std::optional<ViewPair> verify(const std::vector<View>& views, const CandidatePair& candidate, const ViewGraphOptions& options) {
  const View& query = views[candidate.query];
  const View& match = views[candidate.match];
  if (!is_worth_a_closer_look(query.features, match.features, options)) return std::nullopt;
  const std::vector<Match> all = match_features(query.features, match.features, options.matching);
  if (all.size() < options.min_inliers) return std::nullopt;
  const std::vector<Match> matches = consistent_first(query.features, match.features, all);
  const std::vector<RayPair> pairs = ray_pairs(query, match, matches);
  RelativePoseOptions pose_options;
  pose_options.max_error_rad = options.max_error_px / feature_focal_px(match);
  pose_options.max_iterations = options.max_iterations;
  pose_options.min_inliers = options.min_inliers;
  pose_options.seed = pair_seed(options.seed, query.frame, match.frame);
  const auto relative = estimate_relative_pose(pairs, pose_options);
  if (!relative || relative->inliers.size() < options.min_inliers) return std::nullopt;
  ViewPair pair{candidate.query, candidate.match, matches.size(), {}, relative->match_from_query};
  for (const std::size_t i : relative->inliers) pair.inliers.push_back(matches[i]);
  if (!is_proven(query, match, matches, pair.inliers, options)) return std::nullopt;
  pair.median_parallax_deg = deg_from_rad(median_parallax(pairs, relative->inliers, relative->match_from_query));
  pair.rotation_share = fit_rotation(pairs, relative->inliers, pose_options.max_error_rad).share;
  const PlanarScene plane = planar_scene(pairs, *relative, pose_options);
  if (plane.closer) pair.match_from_query = plane.closer->match_from_query;
  pair.planar_ratio = plane.planar_ratio;
  pair.has_rival = !plane.rivals.empty();
  return pair;
}

/// Candidates that are kept together, and lost by a kill before all of them are done.
constexpr std::size_t kBlockSize = 32;

struct VerifiedBlock {
  std::vector<std::optional<ViewPair>> pairs;
  std::size_t num_left = 0;
};

/// The candidates in blocks, with those of a former run filled in.
std::vector<VerifiedBlock> kept_blocks(std::size_t num_candidates, const WorkState* state) {
  std::vector<VerifiedBlock> blocks((num_candidates + kBlockSize - 1) / kBlockSize);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t size = std::min(kBlockSize, num_candidates - b * kBlockSize);
    auto kept = state != nullptr ? state->read_as(numbered_name(kKeptPairs, b), take_pairs) : std::nullopt;
    const bool is_kept = kept && kept->size() == size;
    blocks[b] = is_kept ? VerifiedBlock{std::move(*kept), 0} : VerifiedBlock{{size, std::nullopt}, size};
  }
  return blocks;
}

}  // namespace

std::vector<ViewPair> verify_pairs(const std::vector<View>& views, const std::vector<CandidatePair>& candidates,
                                   const ViewGraphOptions& options) {
  std::vector<VerifiedBlock> blocks = kept_blocks(candidates.size(), options.state);
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (blocks[i / kBlockSize].num_left > 0) left.push_back(i);
  }
  std::mutex mutex;  // of progress and state
  std::size_t num_done = candidates.size() - left.size();
  parallel_for(left.size(), options.num_threads, [&](std::size_t k) {
    const std::size_t i = left[k];
    VerifiedBlock& block = blocks[i / kBlockSize];
    block.pairs[i % kBlockSize] = verify(views, candidates[i], options);
    const std::lock_guard lock(mutex);
    if (--block.num_left == 0 && options.state != nullptr) {
      options.state->write(numbered_name(kKeptPairs, i / kBlockSize), bytes_of(block.pairs));
    }
    ++num_done;
    if (options.progress) options.progress("pairs", num_done, candidates.size());
  });
  std::vector<ViewPair> proven;
  for (VerifiedBlock& block : blocks) {
    for (auto& pair : block.pairs) {
      if (pair) proven.push_back(std::move(*pair));
    }
  }
  return proven;
}

}  // namespace fabloop
