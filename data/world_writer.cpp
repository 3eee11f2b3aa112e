// SPDX-License-Identifier: BSD-3-Clause
#include "data/world_writer.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "data/pair_overlap.h"
#include "data/random.h"
#include "data/renderer.h"
#include "data/sequence_files.h"
#include "frontend/error.h"
#include "frontend/parallel.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFirstTimeNs = 1'500'000'000'000'000'000;

/// Pairs nearer in the sequence than this see the same ground anyway.
constexpr std::size_t kMinPairGap = 10;
constexpr double kMinPairOverlap = 0.05;

constexpr double kDepthUnitM = 0.001;

/// What the widest view of a flight may show beyond the path itself: half a diagonal at the greatest height, and some tilt.
double margin_m(const SyntheticFlightOptions& options) {
  const Camera& camera = options.camera;
  const double half_diagonal = std::atan(0.5 * std::hypot(camera.width, camera.height) / camera.focal_px());
  const double tilt = rad_from_deg(options.flight.forward_pitch_deg + 2 * options.flight.tilt_deg);
  const double height_m = options.flight.mean_height_m + options.flight.height_spread_m;
  return height_m * std::tan(std::min(1.2, half_diagonal + tilt)) + 2;
}

std::int64_t time_ns_of(std::size_t frame, const SyntheticFlightOptions& options) {
  const double seconds = static_cast<double>(frame) * options.flight.spacing_m / options.speed_m_per_s;
  return kFirstTimeNs + std::llround(seconds * 1e6) * 1000;
}

std::string name_of(std::size_t frame, const char* extension) {
  std::string digits = std::to_string(frame);
  digits.insert(0, digits.size() < 4 ? 4 - digits.size() : 0, '0');
  return digits + extension;
}

void write_images(const fs::path& folder, const SyntheticFlight& flight, const SyntheticFlightOptions& options) {
  const bool with_depth = options.depth_images == DepthImages::Written;
  fs::create_directories(folder / "images");
  if (with_depth) fs::create_directories(folder / "depth");
  CameraEffectsOptions effects = options.effects;
  effects.seed = scramble(options.seed + 3);
  const Renderer renderer(flight.world, options.camera);
  const std::size_t count = flight.world_from_camera.size();
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(count, options.num_threads, [&](std::size_t frame) {
    const RenderedView view = renderer.render(flight.world_from_camera[frame]);
    const cv::Mat3b image = photograph(view.image, draw_camera_effects(frame, effects));
    write_image(folder / "images" / name_of(frame, ".jpg"), image, {cv::IMWRITE_JPEG_QUALITY, options.jpeg_quality});
    if (with_depth) {
      cv::Mat millimetres;
      view.depth.convertTo(millimetres, CV_16U, 1.0 / kDepthUnitM);
      write_image(folder / "depth" / name_of(frame, ".png"), millimetres, {});
    }
    const std::scoped_lock lock(mutex);
    ++done;
    if (options.progress) options.progress("images", done, count);
  });
}

void write_frames(const fs::path& path, std::size_t count, const SyntheticFlightOptions& options) {
  OutputFile file(path);
  file.stream() << "# filename,timestamp_s\n";
  for (std::size_t frame = 0; frame < count; ++frame) {
    file.stream() << name_of(frame, ".jpg") << ',' << seconds_from_nanoseconds(time_ns_of(frame, options)) << '\n';
  }
  file.commit();
}

void write_pairs(const fs::path& path, const SyntheticFlight& flight, const Camera& camera) {
  OutputFile file(path);
  file.stream() << "# i,j (0-based positions in frames.csv, j-i>" << kMinPairGap
                << "), distance_m, overlap (intersection / smaller footprint on the true terrain), inliers (empty: not tried)\n"
                << std::fixed;
  for (const auto& pair :
       overlapping_pairs(flight.world.terrain, camera, flight.world_from_camera, kMinPairGap, kMinPairOverlap)) {
    file.stream() << pair.i << ',' << pair.j << ',' << std::setprecision(2) << pair.distance_m << ',' << std::setprecision(3)
                  << pair.overlap << ",\n";
  }
  file.commit();
}

void write_readme(const fs::path& path, const SyntheticFlight& flight, const SyntheticFlightOptions& options) {
  OutputFile file(path);
  file.stream()
      << "A synthetic flight over a meadow, made by fabloop synth (seed " << options.seed << ", " << options.flight.length_m
      << " m, a frame every " << options.flight.spacing_m << " m).\n"
      << "reference.tum is the exact truth, odometry.tum the truth's own steps with errors, chained; both world_from_camera,\n"
      << "metres, x east, y north, z up. pairs.csv lists the frames that see the same ground.\n";
  if (!flight.aliased.copies.empty()) {
    file.stream() << flight.aliased.copies.size() << " of " << flight.aliased.num_columns * flight.aliased.num_rows
                  << " tiles of the ground are copies of others.\n";
  }
  if (options.depth_images == DepthImages::Written) {
    file.stream()
        << "depth/NNNN.png: 16 bit, millimetres along the camera's z axis, through the same lens; 0 where there is none.\n";
  }
  file.commit();
}

Trajectory stamped(const std::vector<Pose>& poses, const SyntheticFlightOptions& options) {
  Trajectory trajectory;
  for (std::size_t frame = 0; frame < poses.size(); ++frame) trajectory.push_back({time_ns_of(frame, options), poses[frame]});
  return trajectory;
}

void check(const SyntheticFlightOptions& options) {
  if (!(options.speed_m_per_s > 0)) throw InputError("synthetic flight: the speed must be positive");
  if (options.jpeg_quality < 1 || options.jpeg_quality > 100)
    throw InputError("synthetic flight: the JPEG quality must be in [1, 100]");
}

}  // namespace

Camera synthetic_camera() {
  return {640, 480, 482.0, 481.0, 322.5, 237.5, DistortionModel::Radtan, {-0.035, 0.012, 0.0006, -0.0004, 0.0}};
}

SyntheticFlight make_synthetic_flight(const SyntheticFlightOptions& options) {
  check(options);
  validate(options.camera, "synthetic flight");
  FlightOptions flight_options = options.flight;
  MeadowOptions meadow_options = options.meadow;
  DriftOptions drift_options = options.drift;
  flight_options.seed = scramble(options.seed);
  meadow_options.seed = scramble(options.seed + 1);
  drift_options.seed = scramble(options.seed + 2);
  meadow_options.num_threads = options.num_threads;
  if (options.progress) meadow_options.progress = options.progress;
  SyntheticFlight flight;
  flight.world_from_camera = plan_flight(flight_options);
  flight.odom_from_camera = drifting_odometry(flight.world_from_camera, drift_options);
  GroundArea area{flight.world_from_camera.front().translation.head<2>(), flight.world_from_camera.front().translation.head<2>()};
  for (const auto& pose : flight.world_from_camera) {
    area.min = area.min.cwiseMin(pose.translation.head<2>());
    area.max = area.max.cwiseMax(pose.translation.head<2>());
  }
  area.min.array() -= margin_m(options);
  area.max.array() += margin_m(options);
  flight.world = make_meadow(area, meadow_options);
  if (options.aliasing.share != 0.0) {
    AliasingOptions aliasing_options = options.aliasing;
    aliasing_options.seed = scramble(options.seed + 4);
    flight.aliased = alias_ground(flight.world, aliasing_options);
  }
  return flight;
}

SyntheticFlight write_synthetic_flight(const fs::path& folder, const SyntheticFlightOptions& options,
                                       OutputFolder::IfExists if_exists) {
  OutputFolder output(folder, if_exists);
  const fs::path& part = output.part_path();
  SyntheticFlight flight = make_synthetic_flight(options);
  write_camera_yaml(part / "camera.yaml", options.camera);
  write_frames(part / "frames.csv", flight.world_from_camera.size(), options);
  write_tum(part / "reference.tum", stamped(flight.world_from_camera, options));
  write_tum(part / "odometry.tum", stamped(flight.odom_from_camera, options));
  write_pairs(part / "pairs.csv", flight, options.camera);
  write_readme(part / "README.txt", flight, options);
  write_images(part, flight, options);
  output.commit();
  return flight;
}

}  // namespace fabloop
