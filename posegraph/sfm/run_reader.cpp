// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/run_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "frontend/csv_lines.h"
#include "frontend/error.h"
#include "frontend/sequence/association.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/sfm/colmap_io.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

std::size_t column_named(const CsvFields& head, const std::string& name, const CsvFail& fail) {
  const auto found = std::find(head.begin(), head.end(), name);
  if (found == head.end()) fail("has no column '" + name + "'; is it the loops.csv of a run?");
  return static_cast<std::size_t>(found - head.begin());
}

std::vector<LoopLink> read_accepted_loops(const fs::path& path) {
  std::vector<LoopLink> loops;
  std::size_t query = 0, match = 0, verdict = 0, width = 0;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (width == 0) {
      query = column_named(fields, "query", fail);
      match = column_named(fields, "match", fail);
      verdict = column_named(fields, "verdict", fail);
      width = fields.size();
      return;
    }
    if (fields.size() <= std::max({query, match, verdict})) fail("has fewer columns than the head line");
    if (fields[verdict] != "Accepted") return;
    loops.push_back({parse_position(fields[query], fail), parse_position(fields[match], fail)});
  });
  return loops;
}

/// The number of vertices that the head announces; leaves the stream behind it.
std::size_t read_ply_head(std::istream& in, const fs::path& path) {
  const auto fail = [&](const std::string& what) { throw InputError(path.string() + ": " + what); };
  std::string line, properties;
  std::size_t count = 0;
  bool is_binary = false, is_ended = false;
  if (!std::getline(in, line) || line != "ply") fail("is no PLY file");
  while (!is_ended && std::getline(in, line)) {
    if (line == "format binary_little_endian 1.0") is_binary = true;
    if (line.starts_with("element vertex ")) {
      const std::string number = line.substr(15);
      if (number.empty() || number.size() > 15 || number.find_first_not_of("0123456789") != std::string::npos) {
        fail("announces no number of vertices");
      }
      count = std::stoull(number);
    }
    if (line.starts_with("property ")) properties += line.substr(9) + ";";
    is_ended = line == "end_header";
  }
  if (!is_ended || !is_binary || !properties.starts_with("float x;float y;float z;uchar red;uchar green;uchar blue;")) {
    fail("is not a binary PLY of float x y z and uchar red green blue; give the points.ply of a run");
  }
  return count;
}

}  // namespace

std::vector<ScenePoint> read_points_ply(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string() + ": cannot be read; a surface needs the run's points");
  const std::size_t count = read_ply_head(in, path);
  std::vector<ScenePoint> points;
  std::array<char, 15> raw{};
  for (std::size_t i = 0; i < count; ++i) {
    if (!in.read(raw.data(), raw.size())) throw InputError(path.string() + ": ends before its last point; copy it again");
    std::array<float, 3> x{};
    std::memcpy(x.data(), raw.data(), sizeof(x));
    ScenePoint point;
    point.x_in_world = Eigen::Vector3d(x[0], x[1], x[2]);
    for (int k = 0; k < 3; ++k) point.red_green_blue[k] = static_cast<unsigned char>(raw[static_cast<std::size_t>(12 + k)]);
    if (point.x_in_world.allFinite()) points.push_back(std::move(point));
  }
  return points;
}

namespace {

/// Cameras, images and points of a run that has no COLMAP model.
Reconstruction read_map(const fs::path& run, const fs::path& sequence_folder, const RunReadOptions& options) {
  const Trajectory trajectory = read_tum(run / "trajectory.tum");
  const Sequence sequence = read_sequence(sequence_folder, {.camera = options.camera, .warn = options.warn});
  std::vector<std::int64_t> times_ns;
  for (const Frame& frame : sequence.frames) times_ns.push_back(frame.time_ns);
  constexpr std::int64_t kSameTimeNs = 10'000'000;
  const auto poses = poses_at(trajectory, times_ns, kSameTimeNs);
  Reconstruction reconstruction;
  reconstruction.cameras = {sequence.camera};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i]) reconstruction.images.push_back({i, sequence.frames[i].image_path, times_ns[i], 0, *poses[i]});
  }
  if (reconstruction.images.empty()) {
    throw InputError((run / "trajectory.tum").string() + ": has no pose at the time of an image of " + sequence_folder.string() +
                     "; are these the run's images?");
  }
  reconstruction.points = read_points_ply(run / "points.ply");
  return reconstruction;
}

/// What the summary says of unit and place; a map with odometry is in metres, and says nothing.
void take_unit_and_place(const fs::path& summary_path, Reconstruction& reconstruction) {
  reconstruction.unit = LengthUnit::Metres;
  std::ifstream file(summary_path);
  if (!file) return;
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (summary.is_discarded()) throw InputError(summary_path.string() + ": is no JSON; copy the run again");
  if (summary.value("unit", "metres") == "arbitrary") reconstruction.unit = LengthUnit::Arbitrary;
  const nlohmann::json::json_pointer place("/georeference/origin");
  if (!summary.contains(place)) return;
  const auto& origin = summary.at(place);
  reconstruction.origin =
      GeoPosition{origin.value("latitude_deg", 0.0), origin.value("longitude_deg", 0.0), origin.value("altitude_m", 0.0)};
}

}  // namespace

MapRun read_map_run(const fs::path& run, const fs::path& sequence_folder, const RunReadOptions& options) {
  MapRun result;
  const fs::path model = run / "colmap";
  result.reconstruction =
      fs::exists(model / "cameras.txt") ? read_colmap_model(model, sequence_folder) : read_map(run, sequence_folder, options);
  take_unit_and_place(run / "summary.json", result.reconstruction);
  if (fs::exists(run / "trajectory_odometry.tum")) result.odometry = read_tum(run / "trajectory_odometry.tum");
  if (fs::exists(run / "loops.csv")) result.loops = read_accepted_loops(run / "loops.csv");
  return result;
}

std::optional<Reconstruction> read_reconstruction(const fs::path& run) {
  if (!fs::exists(run / "colmap" / "cameras.txt")) return std::nullopt;
  Reconstruction map = read_colmap_model(run / "colmap");
  const Trajectory trajectory = read_tum(run / "trajectory.tum");
  if (trajectory.size() != map.images.size()) {
    throw InputError((run / "trajectory.tum").string() + ": has " + std::to_string(trajectory.size()) +
                     " poses where colmap/images.txt has " + std::to_string(map.images.size()) + "; copy the run again");
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) map.images[i].time_ns = trajectory[i].time_ns;
  return map;
}

}  // namespace fabloop
