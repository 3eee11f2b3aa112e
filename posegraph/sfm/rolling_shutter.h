// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posegraph/sfm/rolling_shutter_check.h"
#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/track_triangulation.h"

namespace fabloop {

/// What a map takes a camera's shutter for.
enum class Shutter {
  Global,            ///< All rows at once: right for most cameras that are not moved fast, and where readout is not known.
  RollingEstimated,  ///< Row after row, in a time that the images tell; where they do not, as Global.
  RollingKnown,      ///< Row after row, in a known time.
};

struct RollingShutterOptions {
  Shutter shutter = Shutter::Global;
  double readout_s = 0;  ///< With RollingKnown: from the first row to the last; negative where rows are read from the last on.
  RollingShutterCheckOptions check{};
  /// Whether the time stamps are times. Else images count as one step apart, and so do readout times: a known one means nothing.
  bool has_times = true;
};

/// The readout time that a map was made with.
struct ModelledReadout {
  double readout_s = 0;
  bool has_settled = true;  ///< False: an estimate that still moved, or lost its footing, when the rounds ended.
};

/// Throws InputError for a readout time that is no number or longer than a second, in which no camera reads an image, and for a
/// known one of images without times.
void require_readout(const RollingShutterOptions& options);

/// Gives a segment that was adjusted without readout motions those that the options ask for, and adjusts it under them until
/// they stay: motions follow poses, an estimated readout follows the sightings, and sightings that the plain model had excluded
/// come back. Time stamps are one a view of the scene. Returns the readout time that the segment has now; none where it is taken
/// for global.
std::optional<ModelledReadout> model_rolling_shutter(const Scene& scene, Segment& segment,
                                                     const std::vector<std::int64_t>& times_ns,
                                                     const TrackTriangulationOptions& triangulation,
                                                     const RollingShutterOptions& options = {});

/// Goes on from a readout time: of a segment whose camera or points have changed since it was modelled. Where the images do not
/// tell the readout any more the last one is kept, as not settled.
ModelledReadout follow_rolling_shutter(const Scene& scene, Segment& segment, const std::vector<std::int64_t>& times_ns,
                                       double readout_s, const TrackTriangulationOptions& triangulation,
                                       const RollingShutterOptions& options = {});

/// What there is to tell of a map that was made with such a readout, or as under a global shutter: a shutter that bends it, one
/// that was to be estimated and is not, and why; an estimate that has not settled; a known readout that the images contradict.
/// Empty when there is nothing.
std::string rolling_shutter_verdict(const RollingShutterCheck& check, const std::optional<ModelledReadout>& modelled,
                                    const RollingShutterOptions& options = {});

}  // namespace fabloop
