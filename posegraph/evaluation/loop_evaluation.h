// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/fabmap/ground_truth.h"
#include "posegraph/evaluation/loop_truth.h"

namespace fabloop {

/// What an accepted loop turns out to be.
enum class LoopJudgement {
  True,
  FalsePair,    ///< The frames do not see the same place.
  FalsePose,    ///< They may, but the relative pose is wrong.
  NoReference,  ///< Not judged: one of the frames has no reference pose.
  UnclearPair,  ///< Not judged: the pose is right, but the truth does not say that the pair overlaps enough.
};

/// The rules. The defaults are those of the aerial sequences' ground truth.
struct LoopEvaluationOptions {
  double height_above_ground_m = 60.0;  ///< Sets what a wrong translation is; the flight's own height where known.
  double max_rotation_error_deg = 5.0;  ///< More is a false pose.
  double max_translation_error = 0.10;  ///< Part of the height above ground; more is a false pose.
  double max_direction_error_deg =
      15.0;           ///< For loops without scale, where the true baseline is longer than the last line allows.
  PairRules pairs{};  ///< Which pairs are true and which false.
  /// Where no pairs are known: camera centres further apart [m] show different places, whatever the pose. None: poses alone
  /// decide.
  std::optional<double> false_radius_m{};
  std::size_t exclusion_window = 10;  ///< Frames no further apart than this are not judged as pairs.
  double min_recall_overlap = 0.3;    ///< Queries that have a pair with this overlap are wanted: the recall's denominator.
};

/// An accepted loop and what it is.
struct JudgedLoop {
  std::size_t query = 0;
  std::size_t match = 0;
  LoopJudgement judgement = LoopJudgement::NoReference;
  double rotation_error_deg = 0.0;
  double translation_error_m = 0.0;  ///< With scale only.
  double direction_error_deg = 0.0;  ///< Without scale only.
};

/// How many of a run's loops are right.
struct LoopEvaluation {
  std::size_t num_hypotheses = 0;
  std::size_t num_accepted = 0;
  std::size_t num_true = 0;
  std::size_t num_false = 0;
  std::size_t num_unjudged = 0;
  std::size_t num_with_scale = 0;      ///< Of the accepted ones whose frames have a reference.
  std::optional<double> precision;     ///< true / (true + false); none where nothing was judged.
  std::optional<double> query_recall;  ///< Wanted queries with a true loop; none without pairs.
  std::optional<double> pair_recall;   ///< True pairs further apart than the window with a true loop; none without pairs.
  std::vector<JudgedLoop> loops;       ///< The accepted ones, in order.
};

/// Where no pairs are known: from the radius of true pairs up to this one, metres, camera centres show one place or not, and only
/// a right pose tells. As `wanted_m`, or three times the height above ground, as far as oblique cameras see. Throws InputError
/// for a radius below that of true pairs.
double false_radius_m(const PoseRules& places, double height_above_ground_m, std::optional<double> wanted_m = {});

/// Judges one loop that has a pose, accepted or not. Throws InputError for a frame position beyond the truth's frames.
JudgedLoop judge_loop(const LoopRecord& record, const LoopTruth& truth, const LoopEvaluationOptions& options = {});

/// Judges the accepted loops. Throws InputError for a frame position beyond the truth's frames.
LoopEvaluation evaluate_loops(const std::vector<LoopRecord>& records, const LoopTruth& truth,
                              const LoopEvaluationOptions& options = {});

/// The rules about poses in words.
std::string pose_recipe(const LoopEvaluationOptions& options = {});

/// The rules in words, with their figures: what a reader must know to compare.
std::string recipe(const LoopTruth& truth, const LoopEvaluationOptions& options = {});

/// "true", "false: pair", "false: pose", ...
std::string_view in_words(LoopJudgement judgement);

}  // namespace fabloop
