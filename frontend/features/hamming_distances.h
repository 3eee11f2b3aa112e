// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// M descriptors of bits (CV_8U, M x B bytes) laid out for fast Hamming distances to many others, which the processor counts
/// with an instruction of its own where it has one. Keeps a copy.
class PackedBits {
 public:
  explicit PackedBits(const cv::Mat& descriptors);

  std::size_t size() const { return size_; }

  /// M rounded up to kRowStep.
  std::size_t stride() const;

  /// Number of different bits between N queries (CV_8U, N x B) and all, into N x stride() floats; what lies beyond M is
  /// infinity. Safe in parallel.
  void distances(const cv::Mat& queries, float* distances) const;

 private:
  std::size_t size_ = 0;
  std::size_t num_bytes_ = 0;
  std::vector<std::uint64_t> words_;  ///< stride() rows of ceil(B / 8), zero where there is no bit.
};

/// Number of different bits of two rows.
int hamming_distance(const std::uint8_t* a, const std::uint8_t* b, std::size_t num_bytes);

}  // namespace fabloop
