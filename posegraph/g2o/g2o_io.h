// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/progress.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// How to read a .g2o file.
struct G2oOptions {
  /// What to do with an information matrix that is not positive semi-definite. Published files have some (5021 of 16869 in
  /// `cubicle`), so they are kept as they stand, and optimize() uses the nearest matrix that is. Refuse one's own files.
  enum class IfIndefinite { Keep, Refuse };
  IfIndefinite if_indefinite = IfIndefinite::Keep;
  /// Told how many information matrices were not positive semi-definite, and that poses had to be chained.
  Warn warn;
};

/// Reads `VERTEX_SE3:QUAT`, `EDGE_SE3:QUAT` or `VERTEX_SE2`, `EDGE_SE2` (not both), `FIX`, `#` comments and our own
/// `EDGE_SE3_DIRECTION:QUAT` (columns as EDGE_SE3:QUAT; the translation is a unit direction, without scale). Priors:
/// `EDGE_SE3_PRIOR` (with the id of a `PARAMS_SE3OFFSET` that is the identity, as g2o writes it, or without), `EDGE_PRIOR_SE2`,
/// `EDGE_PRIOR_SE2_XY`, and our own `EDGE_SE3_POSITION_PRIOR id x y z` and `EDGE_SE3_ATTITUDE_PRIOR id qx qy qz qw`, each with
/// 6 information entries. TORO's `VERTEX2`, `EDGE2` (information xx xy yy tt xt yt), `VERTEX3`, `EDGE3` (x y z roll pitch yaw)
/// are read too. Edges between consecutive ids are odometry, the others loops, unless a comment `# kind:
/// odometry|neighbour|loop` precedes the edge. Without vertex lines, vertices are the edges' ids in ascending order, placed by
/// chaining edges. Throws InputError naming file and line for anything else: a wrong number of columns, a number that is not
/// finite, an unknown tag or vertex, a vertex twice, an edge to itself, a quaternion that is not of unit length, a negative
/// information on the diagonal.
PoseGraph read_g2o(const std::filesystem::path& path, const G2oOptions& options = {});

/// Writes what read_g2o() reads, with as many digits as it takes to get the same bits back (2-D angles: the last bit apart).
/// A header comment explains what other programs do not know. The file appears only when it is complete; throws InputError
/// when it cannot be written.
void write_g2o(const std::filesystem::path& path, const PoseGraph& graph);

/// Writes TORO's lines: `VERTEX2`, `EDGE2` or `VERTEX3`, `EDGE3`, with as many digits as it takes, though angles in space read
/// back with the rounding of a few products. Throws InputError for what TORO does not know (edges without scale, priors), and as
/// write_g2o(). Fixed vertices are written as FIX lines, which read_g2o() knows.
void write_toro(const std::filesystem::path& path, const PoseGraph& graph);

}  // namespace fabloop
