// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frontend/work_state.h"
#include "posegraph/sfm/reconstruct.h"
#include "posegraph/sfm/segment_finish.h"

/// Stages of reconstruct() that are more than a call (private).
namespace fabloop {

/// The pairs' matches joined to tracks.
TrackSet tracks_of(const std::vector<View>& views, const std::vector<ViewPair>& pairs);

/// Segments as far as they grow, join, and grow again.
std::vector<Segment> place_views(const Scene& scene, const std::vector<ViewPair>& pairs, ReconstructOptions options,
                                 WorkState& state);

SegmentFinishOptions finish_options(const ReconstructOptions& options);

/// The segment under the shutter that the options ask for, from the one that it has, and what the images say to it. Again
/// whenever the camera has changed.
void model_shutter(const Sequence& sequence, const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                   Reconstructed& result, const ReconstructOptions& options);

/// Warns of what there is to tell of the shutter.
void tell_shutter(const Reconstructed& result, const ReconstructOptions& options);

/// What the images give without loops: the same stages over the pairs of neighbours alone, in the world of the result.
Trajectory odometry_of(const Sequence& sequence, const std::vector<View>& views, std::vector<ViewPair> pairs,
                       const Reconstructed& result, const ReconstructOptions& options);

}  // namespace fabloop
