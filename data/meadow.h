// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "data/world.h"
#include "frontend/progress.h"

namespace fabloop {

/// How a meadow is made.
struct MeadowOptions {
  std::uint64_t seed = 1;          ///< Another number: another meadow.
  double texture_m_per_px = 0.05;  ///< Coarser is faster to make and looks softer from low flights.
  double height_m_per_px = 0.1;    ///< Coarser rounds trees and the shed.
  double sun_elevation_deg = 48;   ///< Lower: longer shadows.
  double sun_azimuth_deg = 140;    ///< From north, clockwise: where the sun stands.
  int num_threads = 0;             ///< 0: all. The meadow does not depend on it.
  Progress progress;
};

/// Makes a meadow over `area`: self-similar grass in four parcels (pasture, mown, hay), and a few things by which a place can
/// be told: paths, hedges, trees, bales, a shed. Throws InputError for an empty or a huge area and for bad options.
World make_meadow(const GroundArea& area, const MeadowOptions& options = {});

}  // namespace fabloop
