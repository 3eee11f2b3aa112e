// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/ground_truth.h"

namespace fabloop {

/// An answer of a recogniser: whether it is right, and how sure the recogniser was.
struct Decision {
  double score = 0.0;
  bool is_true = false;
};

/// What accepting all answers with at least this score brings.
struct PrecisionRecallPoint {
  double threshold = 0.0;
  double precision = 0.0;  ///< True answers among those accepted.
  double recall = 0.0;     ///< True answers accepted, among all that could be.
};

/// Precision against recall, one point for each score that occurs, from the highest threshold to the lowest. Answers with equal
/// scores cannot be told apart by a threshold and are accepted together.
struct PrecisionRecallCurve {
  std::size_t num_positives = 0;  ///< What recall is a part of.
  std::vector<PrecisionRecallPoint> points;
  /// Sum over the points of (R_n - R_(n-1)) P_n, with R_0 = 0: the area under steps, without interpolation.
  double average_precision = 0.0;
  /// The area under straight lines between the points, from recall 0 at the first point's precision. Optimistic.
  double area_trapezoidal = 0.0;
  double recall_at_full_precision = 0.0;  ///< Highest recall with no false answer accepted.
  /// The lowest threshold that accepts no false answer; none where the best score is a false answer's, or there are no answers.
  std::optional<double> full_precision_threshold;
};

/// The curve of answers of which `num_positives` could be true. Throws InputError when there are none, when more answers are true
/// than could be, and for a score that is not a number.
PrecisionRecallCurve precision_recall_curve(std::vector<Decision> decisions, std::size_t num_positives);

/// How much one place looks like what a query shows.
struct ScoredMatch {
  std::size_t place = 0;
  double score = 0.0;
};

/// The answers to one query.
struct ScoredQuery {
  std::size_t frame = 0;             ///< As the ground truth counts them.
  std::size_t num_places = 0;        ///< How many places there were to choose from: [0, num_places).
  std::vector<ScoredMatch> matches;  ///< In any order; places that are missing count as not found.
};

/// The frames of each place, ascending. A place is one frame, or several where places are revisited.
using PlaceFrames = std::vector<std::vector<std::size_t>>;

/// What counts as an answer.
enum class Scored {
  BestOfQuery,  ///< The best match of each query (top-1); recall is over queries that have a true match.
  EveryMatch,   ///< Every match of every query; recall is over all true pairs of query and place.
};

struct PrecisionRecallOptions {
  Scored scored = Scored::BestOfQuery;
  std::vector<std::size_t> recall_at = {1, 5, 10};  ///< The K of recall@K.
};

/// How often one of a query's K best matches is true.
struct RecallAt {
  std::size_t k = 0;
  double recall = 0.0;  ///< Queries with a true match among their K best, among those that have a true match at all.
};

/// How well places were recognised, and by which rules.
struct PrecisionRecall {
  std::size_t num_queries = 0;
  std::size_t num_queries_with_true_match = 0;
  std::size_t num_decisions = 0;  ///< Answers that are judged.
  /// None where no query has a true match: recall then means nothing.
  std::optional<PrecisionRecallCurve> curve;
  std::vector<RecallAt> recall_at;
  std::string recipe;
};

/// The truth of a place. Frames must be within the truth's numbers.
MatchTruth judge_place(const GroundTruth& truth, std::size_t query, const std::vector<std::size_t>& frames);

/// Judges scored matches. A place is a true match when one of its frames is, and is passed over when none is and one is not
/// judged. Within one sequence only frames before the query count. Throws InputError for frames that the truth does not have and
/// for scores that are not numbers.
PrecisionRecall evaluate_recognition(const std::vector<ScoredQuery>& queries, const PlaceFrames& places, const GroundTruth& truth,
                                     const PrecisionRecallOptions& options = {});

}  // namespace fabloop
