// SPDX-License-Identifier: BSD-3-Clause
#include "apps/report_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <unordered_map>

#include "apps/live/live_map.h"
#include "apps/report_images.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

Eigen::Vector3d moved(const Similarity& to, const Eigen::Vector3d& x) { return to.scale * (to.rotation * x) + to.translation; }

/// Frame and position, millimetres: [frame, x, y, z, frame, x, ...].
ordered_json track(const Trajectory& trajectory, const Similarity& to,
                   const std::unordered_map<std::int64_t, std::size_t>& frames) {
  ordered_json numbers = ordered_json::array();
  for (const StampedPose& pose : trajectory) {
    const auto frame = frames.find(pose.time_ns);
    if (frame == frames.end()) continue;
    numbers.push_back(frame->second);
    const Eigen::Vector3d x = moved(to, pose.world_from_camera.translation);
    for (const double value : {x.x(), x.y(), x.z()}) numbers.push_back(std::round(value * 1e3) / 1e3);
  }
  return numbers;
}

/// The reference's times are matched within its own rules, so its frames are those of the nearest times.
ordered_json reference_track(const Trajectory& reference, const std::vector<std::int64_t>& times_ns) {
  ordered_json numbers = ordered_json::array();
  Trajectory frames;
  for (const std::int64_t time_ns : times_ns) frames.push_back({time_ns, {}});
  std::unordered_map<std::int64_t, std::size_t> frame_of_time;
  for (std::size_t i = 0; i < times_ns.size(); ++i) frame_of_time[times_ns[i]] = i;
  for (const PosePair& pair : associate(frames, reference)) {
    numbers.push_back(frame_of_time.at(pair.estimate.time_ns));
    const Eigen::Vector3d& x = pair.reference_from_camera.translation;
    for (const double value : {x.x(), x.y(), x.z()}) numbers.push_back(std::round(value * 1e3) / 1e3);
  }
  return numbers;
}

Eigen::Vector3d vertical(const Trajectory& trajectory, const Similarity& to) {
  Eigen::Matrix3Xd x(3, static_cast<Eigen::Index>(trajectory.size()));
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = moved(to, trajectory[i].world_from_camera.translation);
  }
  return vertical_of(x);
}

struct GreyPoint {
  Eigen::Vector3d x;
  std::uint8_t grey;
};

/// Some of the points of points.ply, evenly over the file; none where there is no such file.
std::vector<GreyPoint> read_points(const fs::path& path, const Similarity& to) {
  constexpr std::size_t kMaxPoints = 30000, kBytes = 3 * sizeof(float) + 3;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::size_t count = 0;
  while (std::getline(file, line) && line != "end_header") {
    if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
  }
  std::vector<GreyPoint> points;
  const std::size_t stride = std::max<std::size_t>(1, (count + kMaxPoints - 1) / kMaxPoints);
  std::array<char, kBytes> bytes{};
  for (std::size_t i = 0; i < count && file.read(bytes.data(), kBytes); ++i) {
    if (i % stride != 0) continue;
    std::array<float, 3> x{};
    std::memcpy(x.data(), bytes.data(), sizeof(x));
    points.push_back({moved(to, {x[0], x[1], x[2]}), static_cast<std::uint8_t>(bytes[12])});
  }
  return points;
}

/// Between which values all but the outermost hundredth lie.
std::pair<double, double> middle_range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 200], values[values.size() - 1 - values.size() / 200]};
}

/// As 16-bit numbers in a box that leaves outliers out, and greys.
ordered_json points_data(const std::vector<GreyPoint>& points) {
  if (points.size() < 2) return nullptr;
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const GreyPoint& point : points) values.push_back(point.x[axis]);
    std::tie(low[axis], high[axis]) = middle_range(std::move(values));
  }
  constexpr double kMax = 65535.0;
  const Eigen::Vector3d step = (high - low).cwiseMax(1e-9) / kMax;
  std::string positions, greys;
  for (const GreyPoint& point : points) {
    if ((point.x.array() < low.array()).any() || (point.x.array() > high.array()).any()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = static_cast<std::uint16_t>(std::lround((point.x[axis] - low[axis]) / step[axis]));
      positions += static_cast<char>(value & 0xff);
      positions += static_cast<char>(value >> 8);
    }
    greys += static_cast<char>(point.grey);
  }
  return {{"origin", {low.x(), low.y(), low.z()}},
          {"step", {step.x(), step.y(), step.z()}},
          {"positions", base64(positions)},
          {"greys", base64(greys)}};
}

}  // namespace

ordered_json map_data(const fs::path& run, const Trajectory& reference, const std::vector<std::int64_t>& frame_times_ns,
                      Alignment alignment) {
  std::unordered_map<std::int64_t, std::size_t> frames;
  for (std::size_t i = 0; i < frame_times_ns.size(); ++i) frames[frame_times_ns[i]] = i;
  const Trajectory final = read_tum(run / "trajectory.tum");
  Similarity to;
  const auto error = absolute_trajectory_error(final, reference, {.alignment = alignment});
  if (error) to = error->reference_from_estimate;
  ordered_json map;
  map["world"] = error ? "reference" : "odometry";
  map["unit"] = error || alignment != Alignment::Sim3 ? "m" : "units";
  map["final"] = track(final, to, frames);
  for (const char* name : {"odometry", "online"}) {
    const fs::path path = run / (std::string("trajectory_") + name + ".tum");
    if (fs::exists(path)) map[name] = track(read_tum(path), to, frames);
  }
  if (!reference.empty()) map["reference"] = reference_track(reference, frame_times_ns);
  const Eigen::Vector3d up = vertical(final, to);
  map["up"] = {up.x(), up.y(), up.z()};
  map["points"] = points_data(read_points(run / "points.ply", to));
  return map;
}

}  // namespace fabloop::apps
