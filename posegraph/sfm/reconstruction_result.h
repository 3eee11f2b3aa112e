// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/sfm/colour_views.h"
#include "posegraph/sfm/growth.h"
#include "posegraph/sfm/reconstruct.h"

/// What reconstruct() tells of segments that came to their end (private).
namespace fabloop {

/// A segment with the sequence's files and the colours of its points.
Reconstruction to_reconstruction(const Sequence& sequence, const ColourViews& views, const Scene& scene, const Segment& segment);

/// Frames without a place and why, parts of their own, and the pairs. The first segment is the result.
void tell_what_is_left(const ColourViews& views, const Scene& scene, const std::vector<ViewPair>& pairs,
                       const std::vector<Segment>& segments, const GrowthOptions& options, Reconstructed& result);

}  // namespace fabloop
