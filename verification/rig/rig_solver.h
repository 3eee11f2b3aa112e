// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "verification/rig/rig_epipolar.h"

namespace fabloop {

/// OpenGV's minimal and linear solvers over the pairs of a rig, which must outlive it.
class RigRelativeSolver {
 public:
  explicit RigRelativeSolver(std::span<const RigRayPair> pairs);
  ~RigRelativeSolver();
  RigRelativeSolver(const RigRelativeSolver&) = delete;
  RigRelativeSolver& operator=(const RigRelativeSolver&) = delete;

  /// From five pairs of the same two cameras: rotations between the bodies with the unit direction of the cameras' baseline as
  /// the translation, the five points in front of both cameras (Nister 2004).
  std::vector<BodyMotion> five_points(std::span<const std::size_t> sample) const;

  /// Lengths of a baseline direction, found by five_points() for cameras at the first pair's origins, that another pair allows:
  /// linear in the generalised epipolar constraint. None when the pair says nothing about it.
  std::optional<BodyMotion> with_length_from(const BodyMotion& direction, std::size_t pair_of_direction, std::size_t sixth) const;

  /// The motion whose camera baseline at the given pair has that direction and the given length.
  BodyMotion with_length(const BodyMotion& direction, std::size_t pair_of_direction, double length) const;

  /// From eight or more pairs (Kneip & Li, CVPR 2014), a local minimum near the rotation that aligns the rays.
  std::optional<BodyMotion> generalised_eigen(std::span<const std::size_t> sample) const;

  /// From seventeen or more pairs, linear.
  std::optional<BodyMotion> seventeen_points(std::span<const std::size_t> sample) const;

 private:
  class Adapter;
  std::span<const RigRayPair> pairs_;
  std::unique_ptr<Adapter> adapter_;
};

}  // namespace fabloop
