// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {
namespace {

/// Why a shutter that was to be estimated is taken for global.
const char* why_global(const RollingShutterCheck& check, const RollingShutterOptions& options) {
  if (!check.is_known) return "the images are too few, or do not tell it from what the calibration may have wrong";
  if (check.is_certain) return "the images show a rolling shutter, but of too little to bend the map, ";
  if (kCertainSigmas * check.shift_sigma_px() < options.check.min_shift_px) return "the images show that it is, or as good as, ";
  return "the images leave it open whether it is rolling, ";
}

}  // namespace

void require_readout(const RollingShutterOptions& options) {
  constexpr double kLongest_s = 1.0;
  if (options.shutter != Shutter::RollingKnown) return;
  if (!(std::abs(options.readout_s) <= kLongest_s)) {
    throw InputError("a readout time of " + std::to_string(options.readout_s) + " s: give seconds between -1 and 1, as 0.03");
  }
  if (!options.has_times) {
    throw InputError(
        "a readout time in seconds needs to know when images were taken, and they have no time stamps: give them in "
        "frames.csv (filename,timestamp_s), or let the images tell the readout");
  }
}

std::optional<ModelledReadout> model_rolling_shutter(const Scene& scene, Segment& segment,
                                                     const std::vector<std::int64_t>& times_ns,
                                                     const TrackTriangulationOptions& triangulation,
                                                     const RollingShutterOptions& options) {
  if (options.shutter == Shutter::Global) return std::nullopt;
  double readout_s = options.readout_s;
  if (options.shutter == Shutter::RollingEstimated) {
    const std::vector<CameraRate> rates = camera_rates(segment.world_from_cameras, times_ns);
    const RollingShutterCheck check = check_rolling_shutter(scene, segment, rates, 0.0, options.check);
    if (!check.is_relevant) return std::nullopt;
    readout_s = check.readout_of_given_camera_s;
  }
  return follow_rolling_shutter(scene, segment, times_ns, readout_s, triangulation, options);
}

ModelledReadout follow_rolling_shutter(const Scene& scene, Segment& segment, const std::vector<std::int64_t>& times_ns,
                                       double readout_s, const TrackTriangulationOptions& triangulation,
                                       const RollingShutterOptions& options) {
  constexpr int kMaxRounds = 6, kRoundsOfKnown = 2;   // motions follow the poses of the round before
  constexpr double kStays = 0.1, kNothing_px = 0.01;  // sigmas; over the image, where there is next to no noise
  const bool is_known = options.shutter == Shutter::RollingKnown;
  ModelledReadout result{readout_s, is_known};
  std::vector<CameraRate> rates = camera_rates(segment.world_from_cameras, times_ns);
  for (int round = 0; round < (is_known ? kRoundsOfKnown : kMaxRounds); ++round) {
    segment.readout_motions = readout_motions(rates, result.readout_s);
    refresh_all_points(scene, segment, triangulation);
    adjust_segment(scene, segment);
    rates = camera_rates(segment.world_from_cameras, times_ns);
    if (is_known) continue;
    const RollingShutterCheck check = check_rolling_shutter(scene, segment, rates, result.readout_s, options.check);
    if (!check.is_known) break;
    const double step_s = check.readout_of_given_camera_s - result.readout_s;
    result.readout_s += step_s;
    result.has_settled = round > 0 && std::abs(step_s) <= std::max(kStays * check.sigma_s, kNothing_px / check.px_per_s);
    if (result.has_settled) break;
  }
  segment.readout_motions = readout_motions(rates, result.readout_s);
  return result;
}

std::string rolling_shutter_verdict(const RollingShutterCheck& check, const std::optional<ModelledReadout>& modelled,
                                    const RollingShutterOptions& options) {
  std::ostringstream text;
  const auto figures = [&] {
    text << std::setprecision(3) << check.shift_px() << " px from the first row to the last (sigma " << check.shift_sigma_px()
         << " px), " << check.readout_s << (options.has_times ? " s by the time stamps" : " of the step from image to image");
  };
  if (options.shutter == Shutter::Global && check.is_relevant) {
    text << "the images show a rolling shutter: ";
    figures();
    text << "; the map is bent accordingly; make it again with --rolling-shutter estimate";
  } else if (options.shutter == Shutter::RollingEstimated && !modelled) {
    text << "the shutter is taken for global: " << why_global(check, options);
    if (check.is_known) figures();
  } else if (options.shutter == Shutter::RollingEstimated && !modelled->has_settled) {
    text << "the readout time has not settled: the map is made with " << std::setprecision(3) << modelled->readout_s
         << (options.has_times ? " s" : " of a step");
    if (check.is_known) {
      text << ", and the images agree best with ";
      figures();
    }
  } else if (options.shutter == Shutter::RollingKnown && check.is_known) {
    RollingShutterCheck off = check;
    off.readout_s -= options.readout_s;
    judge(off, options.check);
    if (off.is_relevant) {
      text << "the images contradict the readout time: they agree best with ";
      figures();
    }
  }
  return text.str();
}

}  // namespace fabloop
