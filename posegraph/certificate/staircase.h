// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/certificate/certificate.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// How optimize_globally() climbs.
struct GlobalOptions {
  /// How to solve; its objective must be Chordal, without a robust loss.
  OptimizeOptions optimize = {.initialization = Initialization::LowestCost};
  CertificateOptions certificate;
  /// Dimensions to add at most. One or two suffice for maps; noise as large as the measurements may want more.
  int max_extra_dimensions = 4;
};

/// What optimize_globally() did.
struct GlobalReport {
  OptimizeReport optimize;       ///< Of the last solve; `initial_cost` is that of the poses given.
  Certificate certificate;       ///< Of the poses returned.
  int num_extra_dimensions = 0;  ///< That the staircase climbed; 0 where the first solution was certified.
};

/// Solves, certifies, and where the certificate is refused climbs the Riemannian staircase: rotations get one dimension more, in
/// which the eigenvector of the negative eigenvalue leads down, until the optimum there is certified; projected back it is
/// polished by optimize(). The poses of lower cost are kept, so nothing gets worse; `certificate` says whether they are global.
/// Where noise is so large that the relaxation is not tight they may not be, and the bound says how far they can be off.
/// Source: Rosen et al., IJRR 2019, algorithms 1 and 3; Boumal, 2015. Throws what certify() throws, and InputError for another
/// objective or a robust loss.
GlobalReport optimize_globally(PoseGraph& graph, const GlobalOptions& options = {});

}  // namespace fabloop
