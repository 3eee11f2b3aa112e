// SPDX-License-Identifier: BSD-3-Clause
#include "data/flight_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "data/noise.h"
#include "data/random.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

/// Wider than high, as fields are.
constexpr double kAspect = 1.35;

/// Spacing of the dense path before frames are taken from it, and how far corners are rounded.
constexpr double kDenseM = 0.25;
constexpr double kRoundingM = 2.5;

using Path2 = std::vector<Eigen::Vector2d>;
using Path3 = std::vector<Eigen::Vector3d>;

/// Corner points of the pattern over a rectangle of `height_m` around the origin.
Path2 waypoints(int num_strips, int num_cross_strips, double height_m) {
  const double w = kAspect * height_m;
  const double h = height_m;
  Path2 points;
  for (int k = 0; k < num_strips; ++k) {
    const double y = h * k / (num_strips - 1);
    points.emplace_back(k % 2 == 0 ? 0 : w, y);
    points.emplace_back(k % 2 == 0 ? w : 0, y);
  }
  const bool ends_east = num_strips % 2 == 1;
  for (int k = 0; k < num_cross_strips; ++k) {
    // Shrunk a little, so that the first strip across does not run along the border.
    const double part = 0.06 + 0.88 * k / (num_cross_strips - 1);
    const double x = ends_east ? w * (1 - part) : w * part;
    points.emplace_back(x, k % 2 == 0 ? h : 0);
    points.emplace_back(x, k % 2 == 0 ? 0 : h);
  }
  const int again = num_strips / 2;
  const double y = h * again / (num_strips - 1) + 0.02 * h;
  points.emplace_back(again % 2 == 0 ? w : 0, y);
  points.emplace_back(again % 2 == 0 ? 0 : w, y);
  points.emplace_back(0, 0.01 * h);
  points.emplace_back(0.45 * w, 0.01 * h);
  for (auto& point : points) point -= Eigen::Vector2d(0.5 * w, 0.5 * h);
  return points;
}

Path2 densify(const Path2& corners) {
  Path2 dense;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d side = corners[i + 1] - corners[i];
    const int steps = std::max(1, static_cast<int>(std::lround(side.norm() / kDenseM)));
    for (int k = 0; k < steps; ++k) dense.push_back(corners[i] + side * k / steps);
  }
  dense.push_back(corners.back());
  return dense;
}

/// Gaussian average along the path, which rounds its corners.
Path2 smoothed(const Path2& path, double deviation_m) {
  const int half = static_cast<int>(3 * deviation_m / kDenseM);
  std::vector<double> weights;
  for (int k = -half; k <= half; ++k)
    weights.push_back(std::exp(-0.5 * (k * kDenseM / deviation_m) * (k * kDenseM / deviation_m)));
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto last = static_cast<int>(path.size()) - 1;
  Path2 result(path.size(), Eigen::Vector2d::Zero());
  for (int i = 0; i <= last; ++i) {
    Eigen::Vector2d& mean = result[static_cast<std::size_t>(i)];
    for (int k = -half; k <= half; ++k) {
      mean += weights[static_cast<std::size_t>(k + half)] / total * path[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
    }
  }
  return result;
}

/// Where the aircraft flies: rounded corners, sideways wander, changing height.
Path3 dense_path(double area_height_m, int num_strips, const FlightOptions& options) {
  const int num_cross_strips = std::max(2, static_cast<int>(std::lround(0.65 * num_strips)));
  const Path2 ground = smoothed(densify(waypoints(num_strips, num_cross_strips, area_height_m)), kRoundingM);
  const auto seed = static_cast<std::uint32_t>(scramble(options.seed ^ 0xF1167));
  Path3 path;
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const double along_m = static_cast<double>(i) * kDenseM;
    const Eigen::Vector2d wander(line_noise(along_m / 35.0, seed), line_noise(along_m / 35.0, seed + 1));
    const double height_m = options.mean_height_m + options.height_spread_m * (0.75 * line_noise(along_m / 110.0, seed + 2) +
                                                                               0.25 * line_noise(along_m / 31.0, seed + 3));
    path.emplace_back(ground[i].x() + 1.2 * wander.x(), ground[i].y() + 1.2 * wander.y(), height_m);
  }
  return path;
}

double length_of(const Path3& path) {
  double length_m = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length_m += (path[i] - path[i - 1]).norm();
  return length_m;
}

/// The pattern whose path is as long as asked, with as few strips as their largest gap allows.
Path3 fit_length(const FlightOptions& options) {
  for (int num_strips = 3;; ++num_strips) {
    // Lengths are nearly in proportion to the area's height, so this converges by a factor of ten or more each time.
    double area_height_m = options.length_m / (2.0 * num_strips);
    Path3 path;
    for (int i = 0; i < 6; ++i) {
      path = dense_path(area_height_m, num_strips, options);
      area_height_m *= options.length_m / length_of(path);
    }
    if (area_height_m / (num_strips - 1) <= options.max_strip_gap_m) return path;
  }
}

/// Heading (from x to y) of the path around its point `i`: of travel over some metres, as an aircraft turns.
double heading_at(const Path3& path, std::size_t i) {
  constexpr std::size_t kReach = 12;
  const Eigen::Vector3d& behind = path[i < kReach ? 0 : i - kReach];
  const Eigen::Vector3d& ahead = path[std::min(path.size() - 1, i + kReach)];
  return std::atan2(ahead.y() - behind.y(), ahead.x() - behind.x());
}

/// World rotation of a camera that looks down, the top of its picture towards `heading_rad`, after it was pitched (nose
/// down) and rolled (right wing down).
Eigen::Quaterniond looking_down(double heading_rad, double pitch_rad, double roll_rad) {
  Eigen::Matrix3d level;
  level.col(0) << std::sin(heading_rad), -std::cos(heading_rad), 0;   // right
  level.col(1) << -std::cos(heading_rad), -std::sin(heading_rad), 0;  // back
  level.col(2) << 0, 0, -1;                                           // down
  return Eigen::Quaterniond(level) * Eigen::AngleAxisd(-pitch_rad, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(-roll_rad, Eigen::Vector3d::UnitY());
}

Pose pose_at(const Path3& path, std::size_t i, std::size_t frame, const FlightOptions& options) {
  Random random(options.seed, 0xA771700000000ULL + frame);
  const auto seed = static_cast<std::uint32_t>(scramble(options.seed ^ 0x7117));
  const double along_m = static_cast<double>(i) * kDenseM;
  // Slow swaying and a faster tremor. The 0.45 is the standard deviation of line_noise.
  const auto sway = [&](std::uint32_t axis) {
    return 0.8 * line_noise(along_m / 15.0, seed + axis) / 0.45 + 0.5 * random.normal();
  };
  const double pitch_deg = options.forward_pitch_deg + options.tilt_deg * sway(0);
  const double roll_deg = options.tilt_deg * sway(1);
  const double heading_rad = heading_at(path, i) + rad_from_deg(options.tilt_deg * sway(2));
  return {looking_down(heading_rad, rad_from_deg(pitch_deg), rad_from_deg(roll_deg)), path[i]};
}

void check(const FlightOptions& options) {
  const auto fail = [](const std::string& what) { throw InputError("flight: " + what); };
  if (!(options.length_m >= 60 && options.length_m <= 20000)) fail("the length must be between 60 and 20000 m");
  if (!(options.spacing_m >= kDenseM && options.spacing_m <= options.length_m / 10)) {
    fail("the spacing of frames must be between 0.25 m and a tenth of the length");
  }
  if (!(options.mean_height_m - options.height_spread_m >= 12)) fail("the flight must stay 12 m above the ground");
  if (!(options.max_strip_gap_m >= 2)) fail("strips must be at least 2 m apart");
}

}  // namespace

std::vector<Pose> plan_flight(const FlightOptions& options) {
  check(options);
  const Path3 path = fit_length(options);
  std::vector<Pose> world_from_camera;
  double along_m = 0;
  for (std::size_t i = 0; i < path.size() && along_m <= options.length_m; ++i) {
    if (i > 0) along_m += (path[i] - path[i - 1]).norm();
    const double due_m = static_cast<double>(world_from_camera.size()) * options.spacing_m;
    if (along_m + 1e-9 >= due_m) world_from_camera.push_back(pose_at(path, i, world_from_camera.size(), options));
  }
  return world_from_camera;
}

}  // namespace fabloop
