// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// The rays of the match sorted by their angle around the baseline. All epipolar planes contain the baseline, so the
/// candidates of a query's ray are neighbours in that order.
///
/// With unit rays m and q (turned into the match frame), direction t, the angles a_m, a_q from t and theta_m, theta_q around
/// it, the epipolar error is e = m . (t x q) = sin a_m sin a_q sin(theta_q - theta_m), and its Sampson distance is at most d
/// only where sin^2(theta_q - theta_m) <= d^2 (1 / sin^2 a_m + 1 / sin^2 a_q). Towards the epipole (a_m to 0) that opens to all
/// of the pencil, so rays are sorted within rings of a factor of two in sin a_m.
class EpipolarPencil {
 public:
  /// `match_from_query` has a translation that is not zero.
  EpipolarPencil(std::span<const Eigen::Vector3d> match_rays, const Pose& match_from_query, double max_error_rad);

  /// Appends to `found` the indices of the rays of the match that are within max_error_rad (Sampson distance on the sphere) of
  /// the epipolar plane of the query's ray, and meet it in front of both cameras or are parallel to within twice that angle.
  void candidates(const Eigen::Vector3d& query_ray, std::vector<int>& found) const;

 private:
  struct Entry {
    double angle = 0;  ///< Around the baseline, in [-pi, pi].
    int index = 0;
  };
  struct Ring {
    double min_sine = 0;         ///< Of the angle from the baseline.
    std::vector<Entry> entries;  ///< Ascending by angle.
  };
  double angle_of(const Eigen::Vector3d& ray) const;
  void candidates_between(const Ring& ring, double low, double high, const Eigen::Vector3d& turned_query_ray,
                          std::vector<int>& found) const;
  bool is_candidate(const Eigen::Vector3d& turned_query_ray, const Eigen::Vector3d& match_ray) const;

  std::span<const Eigen::Vector3d> match_rays_;
  Eigen::Matrix3d rotation_;     ///< match_from_query.
  Eigen::Vector3d direction_;    ///< Unit, from the match to the query, match frame.
  Eigen::Vector3d side_, over_;  ///< With direction_ an orthonormal basis.
  double max_error_rad_ = 0;
  std::vector<Ring> rings_;
};

}  // namespace fabloop
