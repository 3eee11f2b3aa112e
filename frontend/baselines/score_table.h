// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "frontend/fabmap/precision_recall.h"

namespace fabloop {

/// How much one image looks like each place.
struct ScoreRow {
  std::size_t frame = 0;       ///< The query's position in its source.
  std::size_t num_places = 0;  ///< In the map before this image; of them the most recent ones are excluded.
  /// From the first place on; those beyond the end are excluded. Higher: more alike. Minus infinity: not found.
  std::vector<double> scores;
};

/// What a method makes of a sequence: all that precision and recall need, whatever the method.
struct ScoreTable {
  std::string label;                      ///< What the method is.
  std::vector<ScoreRow> rows;             ///< One a query, in their order.
  std::vector<std::size_t> place_frames;  ///< The frame of each place, ascending.
};

/// The `max_matches` best places of each query, by falling score; places that were not found are left out. Of equal scores the
/// earlier place comes first.
std::vector<ScoredQuery> scored_queries(const ScoreTable& table, std::size_t max_matches);

/// Judges a table as `fabloop recognize` judges FAB-MAP: see evaluate_recognition(), which is given the `max_matches` best.
PrecisionRecall judge_scores(const ScoreTable& table, const GroundTruth& truth, std::size_t max_matches,
                             const PrecisionRecallOptions& options = {});

/// Which queries and places there are, with no scores yet: the places' images in order of time, and within one sequence
/// (`queries` and `places` the same images) for each query those before it less the `num_recent_excluded` latest.
ScoreTable empty_scores(const std::vector<std::size_t>& query_frames, const std::vector<std::size_t>& place_frames,
                        bool within_one_sequence, std::size_t num_recent_excluded);

/// Fills a table with the scores of any method, from lines `query,match,score` below a head line that names the columns (others
/// are passed over). Frames count as the truth counts them. Lines about pairs that the table does not ask for (a match that is
/// not before its query, or excluded) are passed over; pairs without a line are not found. Throws InputError naming file and line
/// for frames that are no images, scores that are no numbers, and pairs that come twice.
void read_scores(const std::filesystem::path& path, ScoreTable& table);

}  // namespace fabloop
