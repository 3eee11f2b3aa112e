// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {

void require_readout(const RollingShutterOptions& options) {
  constexpr double kLongest_s = 1.0;
  if (options.shutter == Shutter::RollingKnown && !(std::abs(options.readout_s) <= kLongest_s)) {
    throw InputError("a readout time of " + std::to_string(options.readout_s) + " s: give seconds between -1 and 1, as 0.03");
  }
}

std::optional<double> model_rolling_shutter(const Scene& scene, Segment& segment, const std::vector<std::int64_t>& times_ns,
                                            const TrackTriangulationOptions& triangulation,
                                            const RollingShutterOptions& options) {
  constexpr int kMaxRounds = 6;
  constexpr double kStays = 0.1;  // sigmas
  if (options.shutter == Shutter::Global) return std::nullopt;
  const bool is_known = options.shutter == Shutter::RollingKnown;
  std::vector<CameraRate> rates = camera_rates(segment.world_from_cameras, times_ns);
  double readout_s = options.readout_s;
  if (!is_known) {
    const RollingShutterCheck check = check_rolling_shutter(scene, segment, rates, 0.0, options.check);
    if (!check.is_relevant) return std::nullopt;
    readout_s = check.readout_of_given_camera_s;
  }
  for (int round = 0; round < kMaxRounds; ++round) {
    segment.readout_motions = readout_motions(rates, readout_s);
    refresh_all_points(scene, segment, triangulation);
    adjust_segment(scene, segment);
    rates = camera_rates(segment.world_from_cameras, times_ns);
    const RollingShutterCheck check = check_rolling_shutter(scene, segment, rates, readout_s, options.check);
    const double step_s = is_known ? 0.0 : check.readout_of_given_camera_s - readout_s;
    readout_s += step_s;
    if (round > 0 && std::abs(step_s) <= kStays * check.sigma_s) break;
  }
  segment.readout_motions = readout_motions(rates, readout_s);
  return readout_s;
}

std::string rolling_shutter_verdict(const RollingShutterCheck& check, std::optional<double> modelled_readout_s,
                                    const RollingShutterOptions& options) {
  std::ostringstream text;
  const auto figures = [&](double readout_s) {
    text << std::setprecision(3) << readout_s * check.px_per_s << " px from the first row to the last (sigma "
         << check.shift_sigma_px() << " px), " << readout_s << " s by the time stamps";
  };
  if (options.shutter == Shutter::Global && check.is_relevant) {
    text << "the images show a rolling shutter: ";
    figures(check.readout_s);
    text << "; the map is bent accordingly; make it again with --rolling-shutter estimate";
  } else if (options.shutter == Shutter::RollingEstimated && !modelled_readout_s) {
    text << "the shutter is taken for global: ";
    if (!check.is_known) {
      text << "the images do not tell it from what the calibration may have wrong";
    } else {
      text << "the images leave it open whether it is rolling, ";
      figures(check.readout_s);
    }
  } else if (options.shutter == Shutter::RollingKnown && check.is_known) {
    RollingShutterCheck off = check;
    off.readout_s -= options.readout_s;
    judge(off, options.check);
    if (off.is_relevant) {
      text << "the images contradict the readout time: they agree best with ";
      figures(check.readout_s);
    }
  }
  return text.str();
}

}  // namespace fabloop
