// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "frontend/geometry/pose.h"
#include "verification/matching.h"
#include "verification/triangulation.h"
#include "verification/view.h"

namespace fabloop {

struct NeighbourOptions {
  MatchingOptions matching;
  TriangulationOptions triangulation;
  double max_error_px = 2.0;  ///< Largest distance from the epipolar plane. As the verifier's.
  int min_inliers = 30;       ///< Neighbours share most of their view: fewer inliers mean that something is wrong.
  /// Where the images and the odometry differ by more, one of them is wrong and the pair is left alone.
  double max_rotation_error_deg = 10.0;
  double max_direction_error_deg = 25.0;
  double min_parallax_deg = 1.0;  ///< Below it (hovering) the direction and all depths are noise.
  int max_iterations = 1500;
  std::uint64_t seed = 0;
};

/// What the images say about two views taken shortly after one another.
struct NeighbourLink {
  std::size_t previous = 0;    ///< View::frame of the earlier one.
  Pose previous_from_current;  ///< Rotation and direction from the images, length from the odometry.
  Eigen::Matrix<double, 6, 6> information =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< As Verification::information; none along the direction.
  int num_inliers = 0;
  int num_points = 0;              ///< Triangulated here.
  double rotation_error_deg = 0;   ///< Between odometry and images.
  double direction_error_deg = 0;  ///< The same for the direction of travel.
};

/// Relates two neighbours by their images, starting from the odometry between them (which chooses among the two poses of a
/// plane), and gives the features that both see a depth, with the odometry's baseline as the unit of length (see
/// add_point_measurement() for features that have one already). None when the images do not show
/// enough, contradict the odometry, or have no parallax; then no depth changes.
std::optional<NeighbourLink> link_neighbours(View& previous, View& current, const Pose& previous_from_current_odometry,
                                             const NeighbourOptions& options = {});

}  // namespace fabloop
