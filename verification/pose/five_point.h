// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace fabloop {

/// Samples that the solver works on at once, one a lane of its vectors.
inline constexpr std::size_t kFivePointLanes = 4;
/// A sample has at most this many essential matrices.
inline constexpr std::size_t kMaxFivePointSolutions = 10;

/// Five pairs of rays a lane.
struct FivePointSamples {
  using Coordinate = std::array<double, kFivePointLanes>;
  alignas(32) std::array<std::array<Coordinate, 3>, 5> query;  ///< Pair, coordinate, lane.
  alignas(32) std::array<std::array<Coordinate, 3>, 5> match;  ///< As `query`.
};

/// Matrices E with match^T E query = 0 for all five pairs, row by row, of any scale and sign.
struct FivePointSolutions {
  std::array<std::size_t, kFivePointLanes> count{};
  std::array<std::array<std::array<double, 9>, kMaxFivePointSolutions>, kFivePointLanes> essentials;
};

/// The essential matrices of four samples at once (Nister 2004): what OpenGV's `fivept_nister` computes for one sample, an
/// order of magnitude faster, because four samples fill the lanes of a vector and no matrix lives on the heap. Two roots that
/// lie closer than the grid that separates them are missed, which costs a RANSAC a few samples in a hundred.
FivePointSolutions five_point(const FivePointSamples& samples);

}  // namespace fabloop
