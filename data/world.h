// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace fabloop {

/// A rectangle of ground, world metres (x east, y north).
struct GroundArea {
  Eigen::Vector2d min = {-50, -50};
  Eigen::Vector2d max = {50, 50};
};

/// Heights (metres, world z up) over a rectangle, bilinear between samples. Beyond its border the border's heights go on.
struct HeightMap {
  Eigen::Vector2d origin = {0, 0};  ///< World x, y of sample (row 0, column 0); rows go north, columns east.
  double spacing_m = 1;             ///< Between samples.
  cv::Mat1f heights;                ///< Rows x columns.
  cv::Mat1f block_max;              ///< Largest height of each block of kBlock x kBlock cells; see update_block_max.
  double max_height = 0;            ///< Largest of all.

  static constexpr int kBlock = 16;
};

/// Recomputes `block_max` and `max_height`; call it after the heights were filled.
void update_block_max(HeightMap& map);

/// Height of the ground at world (x, y).
double height_at(const HeightMap& map, double x, double y);

/// Distance along a ray (world frame, `direction` of unit length and pointing down) to where it first meets the heights; none
/// when it starts below them or points up.
std::optional<double> intersect(const HeightMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// A piece of the earth in 2.5-D: one height and one colour for each place. World frame: x east, y north, z up, metres.
struct World {
  GroundArea area;
  HeightMap terrain;  ///< Bare ground, without what grows and stands on it.
  HeightMap surface;  ///< What a camera sees: ground, canopies, roofs.

  /// What the sun makes of the surface, shadows included: `CV_8UC3`, BGR, rows going north, each level half the size of the
  /// one before. Sample (row 0, column 0) of level 0 lies at area.min.
  std::vector<cv::Mat3b> texture;
  double texture_m_per_px = 0.05;  ///< Of level 0.
};

/// Makes the coarser levels of the texture from level 0; call it after that was filled.
void update_texture_levels(World& world);

}  // namespace fabloop
