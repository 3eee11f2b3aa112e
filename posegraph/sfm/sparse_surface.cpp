// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/sparse_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kRobustSigma = 1.4826;  // standard deviations of normal noise per median absolute deviation

double quantile(std::vector<double> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Box {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = -low;

  void add(const Eigen::Vector2d& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
};

/// What the views see of the plane at `height`. Rays that run aslant by more than 60 degrees end there: towards the horizon a
/// picture shows much land and little of it.
Box seen_area(const std::vector<GroundView>& views, double height) {
  const double max_slope = std::tan(rad_from_deg(60));
  Box box;
  for (const GroundView& view : views) {
    const double drop = view.centre().z() - height;
    if (!(drop > 0)) continue;
    const double right = view.camera().width - 1;
    const double bottom = view.camera().height - 1;
    for (const Eigen::Vector3d& ray : bearings(view.camera(), {{0, 0}, {right, 0}, {0, bottom}, {right, bottom}})) {
      const Eigen::Vector3d down = view.ground_from_camera().rotation * ray;
      const Eigen::Vector2d aside = down.head<2>();
      const double slope = down.z() < 0 ? aside.norm() / -down.z() : 1e300;
      if (slope == 0) {
        box.add(view.centre().head<2>());
      } else if (down.z() < 0 || aside.norm() > 0) {
        box.add(view.centre().head<2>() + aside.normalized() * (drop * std::min(slope, max_slope)));
      }
    }
  }
  if (!(box.low.array() < box.high.array()).all()) {
    throw InputError("no camera is above the ground and sees it; is up the right way (--up)?");
  }
  return box;
}

/// The points of each cell, and of those around it.
class Bins {
 public:
  Bins(const GroundGrid& grid, const std::vector<Eigen::Vector3d>& points)
      : grid_(grid), points_(points), bins_(static_cast<std::size_t>(grid.rows) * grid.columns) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d at = grid.position_of(points[i].head<2>());
      const auto column = static_cast<int>(std::lround(at.x()));
      const auto row = static_cast<int>(std::lround(at.y()));
      if (row >= 0 && column >= 0 && row < grid.rows && column < grid.columns) bin(row, column).push_back(i);
    }
  }

  const std::vector<std::size_t>& at(int row, int column) const {
    return bins_[static_cast<std::size_t>(row) * grid_.columns + column];
  }

  /// Of the neighbouring cells; of more of them where these hold too few points to tell a wild one.
  std::vector<double> heights_around(int row, int column) const {
    constexpr std::size_t kEnough = 12;
    constexpr int kFarthest = 8;
    std::vector<double> heights;
    for (int reach = 1; reach <= kFarthest && heights.size() < kEnough; ++reach) {
      heights.clear();
      for (int r = std::max(0, row - reach); r <= std::min(grid_.rows - 1, row + reach); ++r) {
        for (int c = std::max(0, column - reach); c <= std::min(grid_.columns - 1, column + reach); ++c) {
          for (const std::size_t i : at(r, c)) heights.push_back(points_[i].z());
        }
      }
    }
    return heights;
  }

 private:
  std::vector<std::size_t>& bin(int row, int column) { return bins_[static_cast<std::size_t>(row) * grid_.columns + column]; }

  const GroundGrid& grid_;
  const std::vector<Eigen::Vector3d>& points_;
  std::vector<std::vector<std::size_t>> bins_;
};

std::vector<double> heights_without_outliers(const Bins& bins, const std::vector<Eigen::Vector3d>& points, int row, int column,
                                             double flying_height) {
  constexpr double kSigmas = 4;
  constexpr double kAlwaysPlausible = 0.02;
  constexpr double kNeverPlausible = 0.2;  // also where half of the neighbours are wild, as at the flight's border
  const std::vector<double> around = bins.heights_around(row, column);
  const double middle = quantile(around, 0.5);
  std::vector<double> deviations;
  for (const double height : around) deviations.push_back(std::abs(height - middle));
  const double spread = kSigmas * kRobustSigma * quantile(deviations, 0.5);
  const double band = std::clamp(spread, kAlwaysPlausible * flying_height, kNeverPlausible * flying_height);
  std::vector<double> kept;
  for (const std::size_t i : bins.at(row, column)) {
    if (std::abs(points[i].z() - middle) <= band) kept.push_back(points[i].z());
  }
  return kept;
}

HeightField field_through(const GroundGrid& grid, const std::vector<Eigen::Vector3d>& points, double flying_height,
                          std::size_t& num_outliers) {
  const Bins bins(grid, points);
  cv::Mat1f medians(grid.rows, grid.columns, 0.0F);
  cv::Mat1f weights(grid.rows, grid.columns, 0.0F);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (bins.at(row, column).empty()) continue;
      const std::vector<double> heights = heights_without_outliers(bins, points, row, column, flying_height);
      num_outliers += bins.at(row, column).size() - heights.size();
      constexpr std::size_t kFewest = 2;  // a lone point has no witness
      if (heights.size() < kFewest) continue;
      constexpr float kEnough = 4;
      medians(row, column) = static_cast<float>(quantile(heights, 0.5));
      weights(row, column) = std::min(1.0F, static_cast<float>(heights.size()) / kEnough);
    }
  }
  if (cv::countNonZero(weights) == 0) throw InputError("no point lies where the images look; are poses and points of one run?");
  return {grid, fill_smoothly(medians, weights), weights};
}

}  // namespace

SparseSurface sparse_surface(const std::vector<Eigen::Vector3d>& points, const std::vector<GroundView>& views) {
  constexpr std::size_t kFewest = 10;
  if (points.size() < kFewest) {
    throw InputError("a surface needs at least 10 points, and there are " + std::to_string(points.size()));
  }
  std::vector<double> heights, drops, samplings;
  for (const Eigen::Vector3d& x : points) heights.push_back(x.z());
  const double ground = quantile(heights, 0.5);
  const Box box = seen_area(views, ground);
  for (const GroundView& view : views) {
    const double drop = view.centre().z() - ground;
    if (!(drop > 0)) continue;
    drops.push_back(drop);
    samplings.push_back(drop / view.camera().focal_px());
  }
  SparseSurface result;
  result.flying_height = quantile(drops, 0.5);
  result.ground_sampling = quantile(samplings, 0.5);
  // About eight points a cell, but nothing finer than the points' own pixels or so coarse that hills vanish.
  const double area = (box.high - box.low).prod();
  const double spacing =
      std::clamp(std::sqrt(8 * area / static_cast<double>(points.size())), 8 * result.ground_sampling, result.flying_height / 4);
  result.field = field_through(grid_over(box.low, box.high, spacing), points, result.flying_height, result.num_outliers);
  std::vector<double> residuals;
  for (const Eigen::Vector3d& x : points) residuals.push_back(std::abs(x.z() - height_at(result.field, x.head<2>())));
  result.relief = quantile(residuals, 0.98);
  return result;
}

}  // namespace fabloop
