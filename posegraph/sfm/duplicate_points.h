// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/tracks.h"
#include "verification/view.h"

namespace fabloop {

struct DuplicatePointsOptions {
  double max_error_px = 3.0;  ///< Of every sighting of the point that two become.
  double probability = 0.99;  ///< That two estimates of one point lie so near each other, by their covariances.
};

/// Makes two points one where they are one point of the scene: matching did not join those who saw it first with those who came
/// back later, or a feature was found twice at one spot. They must lie as near each other as their covariances allow (of the rays
/// under the present poses, with the noise that the sightings show), look alike as sightings of one point do, be seen at one spot
/// by every view that sees both, and leave no sighting with a larger error. The first track takes the other's features, and the
/// other is empty from then on, so that numbers of tracks stay. Points that are vaguer than five times the usual are left alone.
/// Returns how many points became part of another. `views` and `tracks` are those of the segment's scene.
std::size_t merge_duplicate_points(const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                                   const DuplicatePointsOptions& options = {});

}  // namespace fabloop
