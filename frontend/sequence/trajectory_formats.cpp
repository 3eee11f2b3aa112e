// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/trajectory_formats.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "frontend/names.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

constexpr std::array<Named<TrajectoryFormat>, 3> kFormats{
    {{TrajectoryFormat::Tum, "tum"}, {TrajectoryFormat::Kitti, "kitti"}, {TrajectoryFormat::Euroc, "euroc"}}};

/// Files print 6 or more digits, so that a rotation is off by far less than this.
constexpr double kMaxRotationError = 1e-2;

using Fail = std::function<void(const std::string& what)>;

/// Calls `read` with the words of each line that is neither empty nor a comment; words end at blanks and commas.
void for_each_line(const std::filesystem::path& path, const std::string& form,
                   const std::function<void(const std::vector<std::string>& words, const Fail& fail)>& read) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read; does the file exist?");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const Fail fail = [&](const std::string& what) {
      throw InputError(path.string() + ":" + std::to_string(number) + ": " + what + "; a line is '" + form + "'");
    };
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (!words.empty() && words.front().front() != '#') read(words, fail);
  }
}

double number_of(const std::string& text, const Fail& fail) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail("'" + text + "' is not a finite number");
  }
  return value;
}

void append(Trajectory& trajectory, std::int64_t time_ns, const Pose& pose, const Fail& fail) {
  if (!trajectory.empty() && time_ns <= trajectory.back().time_ns) fail("the time does not ascend");
  trajectory.push_back({time_ns, pose});
}

std::filesystem::path times_beside(const std::filesystem::path& path, const std::filesystem::path& times) {
  return times.empty() ? path.parent_path() / "times.txt" : times;
}

constexpr const char* kKittiForm = "r11 r12 r13 tx r21 r22 r23 ty r31 r32 r33 tz";
constexpr const char* kTimesForm = "seconds";
constexpr const char* kEurocForm = "t_ns,x,y,z,qw,qx,qy,qz";

/// The rotation nearest to a matrix of printed digits.
Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& matrix, const Fail& fail) {
  const bool is_rotation =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() < kMaxRotationError && matrix.determinant() > 0.0;
  if (!is_rotation) fail("the first three columns are no rotation");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose())).normalized();
}

/// As many digits as it takes to read the same number back.
std::ostream& exact(std::ostream& stream) {
  stream.precision(std::numeric_limits<double>::max_digits10);
  return stream;
}

}  // namespace

std::optional<TrajectoryFormat> trajectory_format_named(std::string_view name) { return named(kFormats, name); }

TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read; does the file exist?");
  for (std::string line; std::getline(file, line);) {
    const bool has_commas = line.find(',') != std::string::npos;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    std::size_t count = 0;
    std::string first;
    for (std::string word; stream >> word; ++count) {
      if (count == 0) first = word;
    }
    if (count == 0 || first.front() == '#') continue;
    if (has_commas && count >= 8) return TrajectoryFormat::Euroc;
    if (count == 8) return TrajectoryFormat::Tum;
    if (count == 12) return TrajectoryFormat::Kitti;
    break;
  }
  throw InputError(path.string() +
                   ": is no trajectory; give lines of TUM (8 columns), KITTI (12) or EuRoC (8 or more, with commas)");
}

Trajectory read_kitti(const std::filesystem::path& path, const std::filesystem::path& times) {
  const std::filesystem::path times_path = times_beside(path, times);
  std::vector<std::int64_t> times_ns;
  for_each_line(times_path, kTimesForm, [&](const std::vector<std::string>& words, const Fail& fail) {
    if (words.size() != 1) fail("has " + std::to_string(words.size()) + " columns, not 1");
    if (const auto time_ns = nanoseconds_from_seconds(words[0])) return times_ns.push_back(*time_ns);
    fail("'" + words[0] + "' is not a time in seconds");
  });
  Trajectory trajectory;
  for_each_line(path, kKittiForm, [&](const std::vector<std::string>& words, const Fail& fail) {
    if (words.size() != 12) fail("has " + std::to_string(words.size()) + " columns, not 12");
    Eigen::Matrix<double, 3, 4> rows;
    for (int k = 0; k < 12; ++k) rows(k / 4, k % 4) = number_of(words[static_cast<std::size_t>(k)], fail);
    const std::size_t position = trajectory.size();
    if (position >= times_ns.size()) fail("has no time in " + times_path.string());
    append(trajectory, times_ns[position], {rotation_of(rows.leftCols<3>(), fail), rows.col(3)}, fail);
  });
  if (trajectory.empty()) throw InputError(path.string() + ": has no poses; a line is '" + kKittiForm + "'");
  if (trajectory.size() != times_ns.size()) {
    throw InputError(times_path.string() + ": has " + std::to_string(times_ns.size()) + " times for " +
                     std::to_string(trajectory.size()) + " poses of " + path.string() + "; give one for each");
  }
  return trajectory;
}

void write_kitti(const std::filesystem::path& path, const Trajectory& trajectory, const std::filesystem::path& times) {
  OutputFile poses(path);
  OutputFile stamps(times_beside(path, times));
  for (const auto& [time_ns, pose] : trajectory) {
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      exact(poses.stream()) << rotation(row, 0) << ' ' << rotation(row, 1) << ' ' << rotation(row, 2) << ' '
                            << pose.translation(row) << (row < 2 ? ' ' : '\n');
    }
    stamps.stream() << seconds_from_nanoseconds(time_ns) << '\n';
  }
  poses.commit();
  stamps.commit();
}

Trajectory read_euroc(const std::filesystem::path& path) {
  Trajectory trajectory;
  for_each_line(path, kEurocForm, [&](const std::vector<std::string>& words, const Fail& fail) {
    if (words.size() < 8) fail("has " + std::to_string(words.size()) + " columns, fewer than 8");
    std::int64_t time_ns = 0;
    const auto [end, error] = std::from_chars(words[0].data(), words[0].data() + words[0].size(), time_ns);
    if (error != std::errc() || end != words[0].data() + words[0].size())
      fail("'" + words[0] + "' is no whole number of nanoseconds");
    std::array<double, 7> v{};
    for (std::size_t k = 0; k < v.size(); ++k) v[k] = number_of(words[k + 1], fail);
    const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
    if (std::abs(rotation.norm() - 1.0) > kMaxRotationError) fail("the quaternion is not of unit length");
    append(trajectory, time_ns, {rotation.normalized(), {v[0], v[1], v[2]}}, fail);
  });
  if (trajectory.empty()) throw InputError(path.string() + ": has no poses; a line is '" + kEurocForm + "'");
  return trajectory;
}

void write_euroc(const std::filesystem::path& path, const Trajectory& trajectory) {
  OutputFile file(path);
  file.stream() << "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n";
  for (const auto& [time_ns, pose] : trajectory) {
    const auto& [q, t] = pose;
    exact(file.stream()) << time_ns << ',' << t.x() << ',' << t.y() << ',' << t.z() << ',' << q.w() << ',' << q.x() << ','
                         << q.y() << ',' << q.z() << '\n';
  }
  file.commit();
}

Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::Tum:
      return read_tum(path);
    case TrajectoryFormat::Kitti:
      return read_kitti(path);
    case TrajectoryFormat::Euroc:
      return read_euroc(path);
  }
  return {};
}

void write_trajectory(const std::filesystem::path& path, const Trajectory& trajectory, TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::Tum:
      return write_tum(path, trajectory);
    case TrajectoryFormat::Kitti:
      return write_kitti(path, trajectory);
    case TrajectoryFormat::Euroc:
      return write_euroc(path, trajectory);
  }
}

}  // namespace fabloop
