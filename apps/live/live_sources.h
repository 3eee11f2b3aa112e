// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "apps/live/live_map.h"
#include "posegraph/mapper.h"
#include "posegraph/sfm/reconstruct.h"

namespace fabloop::apps {

/// What there is of a map made with odometry. Loops into earlier maps are left out, since their ends are not on this one.
LiveMap live_map_of(const Map& map);

/// What there is of a map from images alone: of the segment that grows. Pairs beyond the neighbours are its loops, accepted as
/// long as only two views have spoken.
LiveMap live_map_of(const PlacedSoFar& so_far);

}  // namespace fabloop::apps
