// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/pose/scale.h"
#include "verification/view.h"

namespace fabloop {

/// A plane that does not contain the camera's centre: inverse_normal . x = 1 for its points x, so that |inverse_normal| is one
/// over its distance.
struct FittedPlane {
  Eigen::Vector3d inverse_normal = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< Of inverse_normal, from the scatter of the points.
  std::size_t num_points = 0;                            ///< On it.
  double distance() const { return 1.0 / inverse_normal.norm(); }
};

/// The plane that most points lie on, by their inverse depths, which are linear in it: n . ray = 1 / depth. A point is on it when
/// its depth is off by less than `max_relative_error`; half of the points may be off it. None for fewer than three points and for
/// rays that leave the plane open. Deterministic.
std::optional<FittedPlane> fit_plane(const std::vector<Eigen::Vector3d>& unit_rays, const std::vector<double>& depths,
                                     double max_relative_error);

struct PlaneScaleOptions {
  int min_points = 12;
  double min_parallax_rad = 0.01;   ///< Between the rays of a match. Below it their depth is noise.
  double max_relative_error = 0.1;  ///< Relief over height: a point further off the plane is none of it.
  double min_share = 0.7;           ///< Of the matches, how many lie on the plane: else the ground is none.
  double height_sigma = 0.05;       ///< Relative standard deviation of a stated height.
};

/// The length of a translation from a known height of either camera above the ground (View::height_above_ground), where the
/// matches show the ground to be a plane; its slope and the camera's attitude need not be known. None without a height and where
/// there is no plane. It does not agree where both heights are known and contradict one another by more than chance allows
/// (4 standard deviations). `match_from_query` has a unit translation, and `matches` agree with it.
std::optional<Scale> estimate_plane_scale(const View& query, const View& match, const std::vector<Match>& matches,
                                          const Pose& match_from_query, const PlaneScaleOptions& options = {});

}  // namespace fabloop
