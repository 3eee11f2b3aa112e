// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "apps/live_run.h"
#include "posegraph/map_sequence.h"
#include "posegraph/sfm/georeference.h"

namespace fabloop::apps {

/// What `fabloop map` was told.
struct MapArguments {
  std::string sequence;
  std::string odometry, reference, camera, model, out;
  std::string earlier_map, save_map;
  FeatureArguments features;
  std::string new_place = "mean-field", match_by = "features";
  double max_time_difference_s = 0.01;
  bool strict = false;
  bool overwrite = false;
  bool from_images = false;
  std::string gps, gps_use = "witness", refine = "nothing", rolling_shutter = "none";
  double gps_sigma_m = GeoreferenceOptions{}.sigma_m;
  std::size_t gps_neighbours = 0;
  bool no_report = false;
  bool fresh = false;
  bool without_loops = false;
  LiveArguments live;
  MapSequenceOptions options;
};

void add_map_arguments(CLI::App* command, MapArguments& arguments);

}  // namespace fabloop::apps
