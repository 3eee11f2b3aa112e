// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace fabloop {

/// Pairs of rays laid out for counting which of them agree with many essential matrices: a RANSAC's innermost loop.
class EpipolarData {
 public:
  explicit EpipolarData(std::size_t num_pairs);

  void set(std::size_t i, const double* query_ray, const double* match_ray);
  std::size_t size() const { return size_; }

  /// Truncated squared error (MSAC, Torr & Zisserman 2000) of the Sampson distances, in units of the threshold: at most the
  /// number of pairs. Stops adding once above `bound`, and then returns some figure above it. `essential` is row by row, of
  /// any scale; the distances are computed in single precision, good to about 1e-6 rad.
  double cost(const std::array<double, 9>& essential, double max_error_rad,
              double bound = std::numeric_limits<double>::infinity()) const;

 private:
  std::size_t size_;
  std::size_t padded_;
  std::vector<float> coordinates_;  ///< Six rows of `padded_`: query x, y, z, match x, y, z. Zero rays at the end cost nothing.
};

}  // namespace fabloop
