// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/pose/triangulation.h"
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
  /// A distance that the odometry tells less well, relative, is no unit for depths where another is to be had: after a turn the
  /// way between two views is long, and its errors are large against the distance. As well as a step's always suffices: the
  /// nearest view's whose distance is known to half of it.
  double max_distance_sigma = 0.06;
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

/// A feature that two neighbours see, and where it is.
struct NeighbourPoint {
  std::size_t previous_feature = 0;
  std::size_t current_feature = 0;
  Eigen::Vector3d x_in_previous = Eigen::Vector3d::Zero();
  double parallax_rad = 0;
};

/// How two neighbours relate, with the depths that follow from it.
struct SeenNeighbour {
  NeighbourLink link;
  std::vector<NeighbourPoint> points;
};

/// Relates two neighbours by their images, starting from the odometry between them (which chooses among the two poses of a
/// plane), and triangulates the features that both see, with the odometry's baseline as the unit of length. None when the images
/// do not show enough, contradict the odometry, or have no parallax. The seed of the pair is options.seed's for its frames.
std::optional<SeenNeighbour> see_neighbour(const View& previous, const View& current, const Pose& previous_from_current_odometry,
                                           const NeighbourOptions& options = {});

/// Relates two neighbours and gives them their depths.
std::optional<NeighbourLink> link_neighbours(View& previous, View& current, const Pose& previous_from_current_odometry,
                                             const NeighbourOptions& options = {});

/// A view taken shortly before another, and the odometry between them.
struct RecentView {
  const View* view = nullptr;
  Pose recent_from_current;
  double distance_sigma = 0;  ///< Of the odometry: relative_distance_sigma().
};

/// One of them that the images relate to the current view.
struct RecentNeighbour {
  std::size_t recent = 0;  ///< Index into the recent views.
  SeenNeighbour seen;
  double unit_sigma = 0;  ///< Its distance_sigma where that is too large for a unit of depths (NeighbourOptions); else 0.
};

/// Gives the views the depths that they show. Of a vague unit only where a view has no others, whose unit_sigma then tells so;
/// they give way to better ones.
void give_depths(View& recent, View& current, const RecentNeighbour& neighbour);

/// The first `max_links` of the recent views, nearest first, that the images relate to the current one. On up to `num_threads`
/// threads (0: all), without effect on the result.
std::vector<RecentNeighbour> see_recent(std::span<const RecentView> recent, const View& current, std::size_t max_links,
                                        const NeighbourOptions& options = {}, int num_threads = 1);

}  // namespace fabloop
