// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "verification/verdict.h"

namespace fabloop::apps {

/// Where a frame is in the map so far.
struct LivePosition {
  std::size_t frame = 0;
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  std::uint64_t changed = 0;  ///< Number of its last change that can be seen.
};

/// What became of a hypothesis so far.
struct LiveLoop {
  std::size_t query = 0, match = 0;
  Verdict verdict = Verdict::Accepted;
  int num_inliers = 0;
  std::uint64_t changed = 0;
};

/// A map while it grows, as a page draws it. Every item has the number of its last change, so that a page that has seen all up to
/// a number asks for what came after it.
struct LiveMap {
  std::uint64_t last_change = 0;               ///< The largest number of all.
  std::size_t world = 0;                       ///< Another number: the positions have nothing to do with those before.
  std::vector<LivePosition> placed, odometry;  ///< Frames ascending.
  std::vector<LiveLoop> loops;                 ///< In the order of the ledger, which only grows.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::string unit = "m";
  std::optional<std::size_t> newest;  ///< The frame that came last, where they come one after the other.

  /// Largest extent of the placed frames along an axis.
  double extent() const;
};

/// The map as it is `now` (without numbers), numbered after the one `before`: what has moved by less than can be seen keeps its
/// place and its number. When frames have lost their places it is another world.
LiveMap numbered(const LiveMap& before, LiveMap now);

/// The vertical that a page draws of N positions (3 x N): across the plane that they mostly lie in; z or -y, the usual verticals,
/// where one is near it.
Eigen::Vector3d vertical_of(const Eigen::Matrix3Xd& positions);

}  // namespace fabloop::apps
