// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// How certify() judges.
struct CertificateOptions {
  /// Certified: no poses whatsoever cost less by more than this part of the cost. Larger for solutions that have not fully
  /// converged.
  double max_relative_gap = 1e-6;
};

/// What is known about the distance of a solution from the global optimum of the chordal objective.
struct Certificate {
  bool is_global = false;    ///< `cost - lower_bound` is at most `max_relative_gap * cost`, rounding apart.
  double cost = 0.0;         ///< At the given rotations with the best translations for them.
  double lower_bound = 0.0;  ///< No poses cost less. Zero where nothing better is known.
  /// Smallest eigenvalue of S = Q - Lambda across the solution's own null space. Positive: the solution is a strict optimum.
  /// Below zero by more than rounding: in a higher dimension a way leads down (escape_local_minimum() takes it).
  double smallest_eigenvalue = 0.0;

  /// (cost - lower_bound) / cost; zero where the cost is zero.
  double relative_gap() const;
  /// One line.
  std::string brief() const;
};

/// Whether the poses are the global optimum of the chordal objective, without robust losses: with S = Q - Lambda, the quadratic
/// form of the rotations (translations at their best) less the multipliers of their orthogonality, any rotations cost at least
/// tr(Lambda) + d n min(0, lambda_min(S)), and a stationary point costs tr(Lambda). The sign of lambda_min is proved by the
/// inertia of one sparse LDL^T factorisation of S + eta I, eta = max_relative_gap * cost / (d n); its value comes from Lanczos
/// iterations on the inverse. Source: Rosen et al., IJRR 2019, theorem 7 and eq. 107-109; factorising the form with explicit
/// translations, whose Schur complement Q is, keeps it sparse.
/// Throws InputError for a graph that check() refuses, edges without scale, priors, or a component with more than one fixed
/// vertex.
Certificate certify(const PoseGraph& graph, const CertificateOptions& options = {});

}  // namespace fabloop
