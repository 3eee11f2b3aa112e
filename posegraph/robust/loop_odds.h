// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// The chi-square at which an edge between its vertices is as likely false as right, one an edge. A right one errs by its
/// covariance (isotropic, with the traces of its blocks). A false one says that two places of the map, whichever they are, are
/// near, so that its translation errs as places differ: with twice the covariance of positions; its rotation may be any. For
/// errors small beside the map, the two densities are equal where
///
///   chi2 = ln det(2 C + S_t) / det S_t + 2 ln(8 pi^2) - ln det(2 pi S_r) + 2 ln((1 - p_false) / p_false)
///
/// (2 pi in place of 8 pi^2 in the plane). `p_false` is the share of false ones before anything is known. Zero for edges without
/// scale, whose direction says too little.
std::vector<double> even_odds_chi2(const PoseGraph& graph, double p_false = 0.5);

}  // namespace fabloop
