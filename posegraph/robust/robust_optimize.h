// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/robust/back_end.h"
#include "posegraph/robust/noise_factors.h"

namespace fabloop {

/// What robust_optimize() decided about an edge.
enum class EdgeVerdict {
  Trusted,       ///< Not of a doubted kind: never rejected.
  Kept,          ///< A loop that agrees with the map.
  Rejected,      ///< A loop that does not.
  ForcedAccept,  ///< Kept because `RobustOptions::accept` says so.
  ForcedReject,  ///< Left out because `RobustOptions::reject` says so.
};

/// "Kept", ...
std::string_view to_string(EdgeVerdict verdict);

/// An edge in the end.
struct EdgeDecision {
  double chi2 = 0.0;    ///< Squared whitened error at the returned poses, whatever its weight.
  double weight = 1.0;  ///< Part of its information that the poses were asked to fit, in [0, 1].
  EdgeVerdict verdict = EdgeVerdict::Trusted;
};

/// Where robust_optimize() begins.
enum class RobustStart {
  /// Where the trusted edges alone lead: no false loop can have bent it. Several trajectories are placed by align_sessions().
  Odometry,
  /// The poses as they are, after an earlier solve, say.
  AsGiven,
};

/// What errors are measured by.
enum class NoiseScale {
  /// The information matrices, unless neighbouring loops show that these promise far less than they hold: see
  /// observed_noise_scale(). Truncated graduation ends with what the edges kept show: see estimate_noise().
  Observed,
  /// The information matrices.
  AsDeclared,
};

/// What robust_optimize() may be told.
struct RobustOptions {
  /// The default holds out where half of the loops are false and stays fast (figures in the README). Dynamic covariance scaling
  /// where odometry is good and loops are few.
  BackEnd back_end = BackEnd::GncTruncated;
  /// A right loop has a chi-square below the threshold with this probability. Lower rejects more. Where the information
  /// matrices promise too much, right loops are rejected too: mend those, or raise this. Truncated graduation keeps right loops
  /// with this probability at least: see refine_choice().
  double inlier_probability = 0.99;
  /// AsDeclared where the information matrices are honest and few of the loops are right.
  NoiseScale noise = NoiseScale::Observed;
  /// Kinds of edges that may be false. The others are trusted, and judge them.
  std::vector<EdgeKind> doubted = {EdgeKind::Loop};
  /// AsGiven to go on from an earlier solve.
  RobustStart start = RobustStart::Odometry;
  /// Positions of doubted edges that are right whatever they look like, and of those that are false: a person's decisions.
  std::vector<std::size_t> accept = {}, reject = {};
  /// Weights of the edges in an earlier report (`RobustReport::weights()`), one an edge: graduated back ends then start from
  /// them and from the poses as given, and only see what changed. Empty: from scratch.
  std::vector<double> warm_weights = {};
  /// Graduated back ends: factor by which the cost nears the true one in each step. Closer to 1 is safer and slower.
  double gnc_factor = 2.0;
  /// Pairwise consistency: work of the search for the largest set, which bounds its time. See MaxCliqueOptions.
  std::size_t max_clique_work = 2'000'000'000;
  /// Objective and bounds of the solves. Its robust loss is not used.
  OptimizeOptions optimize = {};
};

/// What robust_optimize() did.
struct RobustReport {
  OptimizeReport last_solve;        ///< Its `edges` are those that had a weight, in the graph's order.
  std::vector<EdgeDecision> edges;  ///< One per edge, in the graph's order.
  std::size_t num_solves = 0;
  std::size_t num_kept = 0;      ///< Doubted edges that are kept, forced ones too.
  std::size_t num_rejected = 0;  ///< Doubted edges that are not.
  /// Thresholds were taken to be so many times what the information tells, at first where loops are exchanged later.
  double noise_scale = 1.0;
  /// Truncated graduation: the noise by which the loops were chosen in the end.
  NoiseFactors noise = {};
  /// Pairwise consistency: false when the search was ended before the set was proven to be the largest.
  bool is_proven = true;

  /// The weights of the edges: what a later solve may start from (`RobustOptions::warm_weights`).
  std::vector<double> weights() const;
  /// One line: loops kept and rejected, cost, solves.
  std::string brief() const;
};

/// Moves the vertices to where the trusted edges and the loops worth believing agree best, in place, and says which those are.
/// The same input gives the same bytes. Throws InputError as optimize() does, and for a forced edge that is not there, is not of
/// a doubted kind, or is both accepted and rejected.
RobustReport robust_optimize(PoseGraph& graph, const RobustOptions& options = {});

}  // namespace fabloop
