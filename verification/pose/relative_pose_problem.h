// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "verification/pose/epipolar_cost.h"
#include "verification/pose/epipolar_equations.h"
#include "verification/pose/epipolar_refinement.h"
#include "verification/pose/five_point.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {

/// An essential matrix with respect to which rays agree or not, row by row.
using Essential = std::array<double, 9>;

/// What Ransac looks for between two views: a Problem as ransac.h says, four samples at once.
class RelativePoseProblem {
 public:
  using Model = Pose;
  using Candidate = Essential;
  static constexpr std::size_t kSampleSize = 5;
  static constexpr std::size_t kBatchSize = kFivePointLanes;
  using Samples = std::array<std::array<std::size_t, kSampleSize>, kBatchSize>;

  /// `pairs` and `options` must outlive the problem.
  RelativePoseProblem(std::span<const RayPair> pairs, const RelativePoseOptions& options);

  std::size_t size() const { return pairs_.size(); }

  std::vector<Essential> solve(const Samples& samples) const {
    return options_.solver == FivePointSolver::OpenGv ? solve_by_opengv(samples) : solve_in_lanes(samples);
  }

  double cost(const Essential& essential, double bound) const { return data_.cost(essential, options_.max_error_rad, bound); }

  /// None when fewer inliers than a sample lie in front of both cameras.
  std::optional<Pose> model_of(const Essential& essential) const;

  /// Pairs behind a camera are as far off as can be: of a plane's two poses often one alone has all in front.
  auto evaluator(const Pose& match_from_query) const {
    return [angles = equations_.angles(frame_of(match_from_query), options_.max_error_rad)](std::size_t i) {
      return angles[i] * angles[i];
    };
  }

  Pose refine(const Pose& match_from_query, const std::vector<std::size_t>& inliers) const;

 private:
  /// Inliers that lie in front of both cameras.
  std::size_t num_in_front(const Pose& match_from_query) const;
  std::optional<Pose> most_in_front(const std::array<Pose, 4>& poses) const;
  std::vector<Essential> solve_in_lanes(const Samples& samples) const;
  std::vector<Essential> solve_by_opengv(const Samples& samples) const;

  std::span<const RayPair> pairs_;
  const RelativePoseOptions& options_;
  EpipolarData data_;
  EpipolarEquations equations_;
};

}  // namespace fabloop
