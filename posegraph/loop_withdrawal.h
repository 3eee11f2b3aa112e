// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/pose_graph.h"
#include "verification/chi_square.h"

namespace fabloop {

/// Whether an edge is a loop that the solved map contradicts: right ones have a smaller chi-square with probability
/// `max_loop_surprise`. At 1 none does.
inline bool contradicts_map(const Edge& edge, double chi2, double max_loop_surprise) {
  if (edge.kind != EdgeKind::Loop || max_loop_surprise >= 1.0) return false;
  return chi2 > chi_square_quantile(max_loop_surprise, edge.has_scale ? 6 : 5);
}

}  // namespace fabloop
