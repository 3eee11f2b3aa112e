// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/loop_truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frontend/csv_lines.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

bool parse_flag(const std::string& text, const CsvFail& fail) {
  if (text == "1" || text == "true") return true;
  if (text != "0" && text != "false" && !text.empty()) fail("'" + text + "' is not 0 or 1");
  return false;
}

constexpr std::array<const char*, 11> kLoopColumns = {"query", "match", "verdict", "has_scale", "tx", "ty",
                                                      "tz",    "qx",    "qy",      "qz",        "qw"};

/// Which field each of kLoopColumns is.
using LoopLayout = std::array<std::size_t, kLoopColumns.size()>;

std::optional<std::size_t> column_named(const std::string& name, const CsvFields& head) {
  const auto found = std::find(head.begin(), head.end(), name);
  if (found == head.end()) return std::nullopt;
  return static_cast<std::size_t>(found - head.begin());
}

LoopLayout read_head(const CsvFields& head, const CsvFail& fail) {
  LoopLayout layout{};
  for (std::size_t i = 0; i < kLoopColumns.size(); ++i) {
    const auto found = column_named(kLoopColumns[i], head);
    if (!found) {
      fail("the head line has no column '" + std::string(kLoopColumns[i]) +
           "'; write query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw");
    }
    layout[i] = *found;
  }
  return layout;
}

/// Where a line says which session its query and its match are of; older files do not.
struct SessionColumns {
  std::optional<std::size_t> query, match;
};

bool is_within_session(const CsvFields& fields, const SessionColumns& columns) {
  return !columns.query || !columns.match || fields[*columns.query] == fields[*columns.match];
}

LoopRecord read_loop(const CsvFields& fields, const LoopLayout& layout, const CsvFail& fail) {
  constexpr double kMaxQuaternionNormError = 1e-2;
  const auto field = [&](std::size_t column) -> const std::string& { return fields[layout[column]]; };
  LoopRecord record;
  record.query = parse_position(field(0), fail);
  record.match = parse_position(field(1), fail);
  record.verdict = field(2);
  if (!record.accepted()) return record;
  record.has_scale = parse_flag(field(3), fail);
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = parse_number(field(4 + i), fail);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (std::abs(rotation.norm() - 1.0) > kMaxQuaternionNormError) fail("the quaternion (qx,qy,qz,qw) is not of unit length");
  record.match_from_query = Pose{rotation.normalized(), {v[0], v[1], v[2]}};
  return record;
}

}  // namespace

bool LoopRecord::accepted() const { return verdict == "Accepted" || verdict == "accepted"; }

std::vector<LoopRecord> read_loops(const std::filesystem::path& path) {
  std::optional<LoopLayout> layout;
  SessionColumns sessions;
  std::size_t num_columns = 0;
  std::vector<LoopRecord> records;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (!layout) {
      layout = read_head(fields, fail);
      num_columns = fields.size();
      sessions = {column_named("session", fields), column_named("match_session", fields)};
      return;
    }
    if (fields.size() != num_columns) {
      fail("has " + std::to_string(fields.size()) + " columns, but the head line has " + std::to_string(num_columns));
    }
    if (is_within_session(fields, sessions)) records.push_back(read_loop(fields, *layout, fail));
  });
  if (!layout) throw InputError(path.string() + ": has no head line; write query,match,probability,verdict,... first");
  return records;
}

std::vector<std::int64_t> read_frame_times(const std::filesystem::path& path) {
  std::vector<std::int64_t> times_ns;
  bool first = true;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    const auto time_ns = fields.size() >= 2 ? nanoseconds_from_seconds(fields[1]) : std::nullopt;
    // A head line without '#' has no time in it.
    if (!time_ns && !first) fail("has no time; a line is 'filename,timestamp_s'");
    if (time_ns) times_ns.push_back(*time_ns);
    first = false;
  });
  if (times_ns.empty()) throw InputError(path.string() + ": has no frames; a line is 'filename,timestamp_s'");
  return times_ns;
}

LoopTruth read_loop_truth(const std::filesystem::path& sequence_folder, double max_time_difference_s) {
  const auto frames = sequence_folder / "frames.csv";
  const auto track = sequence_folder / "track.csv";
  const auto pairs = sequence_folder / "pairs.csv";
  const Trajectory reference = read_tum(sequence_folder / "reference.tum");
  const auto times_ns = read_frame_times(!std::filesystem::exists(frames) && std::filesystem::exists(track) ? track : frames);
  LoopTruth truth;
  truth.world_from_camera = reference_poses(times_ns, reference, max_time_difference_s);
  if (std::filesystem::exists(pairs)) truth.pairs = read_pairs(pairs);
  return truth;
}

std::vector<std::optional<Pose>> reference_poses(const std::vector<std::int64_t>& frame_times_ns, const Trajectory& reference,
                                                 double max_time_difference_s) {
  const auto max_difference_ns = static_cast<std::int64_t>(std::llround(max_time_difference_s * 1e9));
  std::vector<std::optional<Pose>> poses(frame_times_ns.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::int64_t time_ns = frame_times_ns[i];
    auto best = std::lower_bound(reference.begin(), reference.end(), time_ns,
                                 [](const StampedPose& stamped, std::int64_t time) { return stamped.time_ns < time; });
    if (best != reference.begin() && (best == reference.end() || time_ns - std::prev(best)->time_ns <= best->time_ns - time_ns))
      --best;
    if (best == reference.end()) continue;
    if (std::abs(best->time_ns - time_ns) <= max_difference_ns) poses[i] = best->world_from_camera;
  }
  return poses;
}

}  // namespace fabloop
