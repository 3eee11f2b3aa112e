// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// How a flight runs.
struct FlightOptions {
  std::uint64_t seed = 1;
  double length_m = 1700;        ///< Path length. The pattern shrinks with it, so a short flight returns to places as well.
  double spacing_m = 4;          ///< Between frames, along the path.
  double mean_height_m = 29;     ///< Above the mean ground.
  double height_spread_m = 7;    ///< The height wanders between the mean less this and the mean plus this.
  double max_strip_gap_m = 22;   ///< Between neighbouring strips: less makes them overlap more.
  double tilt_deg = 2.5;         ///< Standard deviation of roll and pitch.
  double forward_pitch_deg = 3;  ///< By how much the nose hangs in forward flight; the camera then looks back a little.
};

/// A mapping flight over an area around the origin: strips there and back (each flown against its neighbour), strips across
/// them, one strip again the other way round, home, and the beginning of the first strip once more.
/// Returns world_from_camera of frames `spacing_m` apart along the path; the camera looks down, the top of its picture to the
/// front. World: x east, y north, z up, 0 at the mean ground. Throws InputError for options that make no flight.
std::vector<Pose> plan_flight(const FlightOptions& options = {});

}  // namespace fabloop
