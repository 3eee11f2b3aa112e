// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace fabloop {

/// Every way in which a hypothesis can end. The first gate that fails names it.
enum class Verdict {
  Accepted,
  TooFewMatches,      ///< Too few features of the two views look alike.
  NoPose,             ///< No relative pose explains even a handful of the matches.
  TooFewInliers,      ///< Fewer matches agree with the best pose than asked for.
  AccidentalInliers,  ///< As many would agree by accident.
  InliersInCorner,    ///< The inliers cover too little of either image: the views touch rather than overlap.
  RepeatedTexture,    ///< Another set of the matches has a pose of its own, nearly as well supported: rows of crops, tiles, windows.
  NoParallax,         ///< The views differ by a rotation, and no depth tells how far apart they are.
  AmbiguousPose,      ///< A different pose explains the same matches as well: a plane whose two poses nothing tells apart.
  ScaleDisagrees,     ///< The known points and the rays, or the points of both sides, give different poses.
  PoorlyConstrained,  ///< The inliers leave the pose too uncertain.
  Improbable,         ///< All gates passed, but the loop is not as probable as asked for.
  Unconfirmed,        ///< Proved, but not yet seen by enough consecutive queries. Only a loop closer can tell.
  ContradictsMap,     ///< Proved by its images, but the rest of the map says otherwise. Only a map can tell.
};

/// The enumerator's name.
std::string_view to_string(Verdict verdict);

}  // namespace fabloop
