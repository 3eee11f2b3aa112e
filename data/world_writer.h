// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "data/aliasing.h"
#include "data/flight_plan.h"
#include "data/meadow.h"
#include "data/odometry_drift.h"
#include "data/photograph.h"
#include "data/world.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/output_file.h"
#include "frontend/progress.h"

namespace fabloop {

/// The usual camera of a small aircraft: 640 x 480, 67 degrees wide, a mild plumb-bob lens.
Camera synthetic_camera();

/// Whether depth images are written beside the photographs.
enum class DepthImages { None, Written };

/// A whole synthetic flight. Seeds of the parts are derived from `seed`; those in the parts' own options are not looked at.
struct SyntheticFlightOptions {
  std::uint64_t seed = 1;
  Camera camera = synthetic_camera();
  FlightOptions flight;
  MeadowOptions meadow;
  AliasingOptions aliasing;  ///< By default no ground looks like another.
  CameraEffectsOptions effects;
  DriftOptions drift;
  DepthImages depth_images = DepthImages::None;
  double speed_m_per_s = 5;  ///< Turns metres into time stamps.
  int jpeg_quality = 95;     ///< In [1, 100].
  int num_threads = 0;       ///< 0: all. What is written does not depend on it.
  Progress progress;
};

/// What was flown and where.
struct SyntheticFlight {
  World world;
  AliasedGround aliased;                ///< Which of its ground is a copy.
  std::vector<Pose> world_from_camera;  ///< The truth.
  std::vector<Pose> odom_from_camera;   ///< What the odometry believes; starts at the true first pose.
};

/// Plans the flight, makes a meadow around it, and lets the odometry drift. Throws InputError for bad options.
SyntheticFlight make_synthetic_flight(const SyntheticFlightOptions& options = {});

/// Renders a synthetic flight into a sequence folder: `images/NNNN.jpg`, `frames.csv`, `camera.yaml`, `reference.tum`,
/// `odometry.tum`, `pairs.csv`, `README.txt`, and with depth images `depth/NNNN.png` (16 bit, millimetres along the camera's
/// z axis, 0 where there is none). The folder appears only when it is complete. Throws InputError for bad options, for a
/// folder that exists (unless it is to be replaced) and when it cannot be written. Returns what was flown.
SyntheticFlight write_synthetic_flight(const std::filesystem::path& folder, const SyntheticFlightOptions& options = {},
                                       OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse);

}  // namespace fabloop
