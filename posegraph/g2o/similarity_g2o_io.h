// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "posegraph/g2o/g2o_io.h"
#include "posegraph/similarity_graph.h"

namespace fabloop {

/// Whether the first vertex or edge of a .g2o file is one of similarities. False for files without any; throws InputError where
/// the file cannot be read.
bool has_similarities(const std::filesystem::path& path);

/// Reads a graph of similarities in either of two forms, or both mixed.
/// Ours continues the SE3 lines: `VERTEX_SIM3:QUAT id x y z qx qy qz qw s` and `EDGE_SIM3:QUAT i j x y z qx qy qz qw s` with the
/// 28 upper-triangular information entries in the order translation, rotation, log s; the vertex is world_from_frame, the edge
/// i_from_j, and x_in_i = s R x_in_j + t.
/// g2o's own (types/sim3/types_seven_dof_expmap.cpp): `VERTEX_SIM3:EXPMAP id w(3) u(3) sigma [fx fy cx cy]` and
/// `EDGE_SIM3:EXPMAP i j w(3) u(3) sigma` with 28 entries in that order: the logarithms of the same similarities, rotation
/// first. Calibrations are not kept.
/// `FIX`, comments, kinds of edges, files without vertices and errors are as in read_g2o().
SimilarityGraph read_similarity_g2o(const std::filesystem::path& path, const G2oOptions& options = {});

/// Writes our form, with as many digits as it takes to get the same bits back, under a comment that states it. The file appears
/// only when it is complete; throws InputError when it cannot be written.
void write_g2o(const std::filesystem::path& path, const SimilarityGraph& graph);

}  // namespace fabloop
