// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "data/world_writer.h"

namespace fabloop {

/// A camera with few pixels and the whole lens.
inline Camera tiny_camera() { return scaled(synthetic_camera(), 0.125); }

/// A flight that takes no time to make: few small images over a coarse world.
inline SyntheticFlightOptions tiny_flight_options() {
  SyntheticFlightOptions options;
  options.camera = tiny_camera();
  options.flight.length_m = 70;
  options.flight.spacing_m = 6;
  options.flight.mean_height_m = 16;
  options.flight.height_spread_m = 2;
  options.meadow.texture_m_per_px = 0.25;
  options.meadow.height_m_per_px = 0.3;
  return options;
}

}  // namespace fabloop
