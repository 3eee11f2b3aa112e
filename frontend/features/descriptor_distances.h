// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// M descriptors (CV_32F, M x D) laid out for fast distances to many others. Keeps a copy.
///
/// Exhaustive comparison of descriptors is most of the work of matching, of looking up words and of k-means, so it has a
/// kernel of its own, chosen at run time for the processor. (The BLAS of a distribution falls back to SSE3 on processors
/// younger than itself.) The same machine gives the same bits, whatever the number of threads and the order of calls.
class PackedDescriptors {
 public:
  explicit PackedDescriptors(const cv::Mat& descriptors);

  std::size_t size() const { return size_; }

  /// M rounded up to kRowStep.
  std::size_t stride() const { return squared_norms_.size(); }

  /// Squared Euclidean distances of N queries (CV_32F, N x D, continuous) to all: N x M. Safe in parallel.
  cv::Mat1f squared_distances(const cv::Mat& queries) const;

  /// The same into N x stride() floats; what lies beyond M is infinity.
  void squared_distances(const cv::Mat& queries, float* distances) const;

 private:
  std::size_t size_ = 0;
  std::size_t dimension_ = 0;
  std::vector<float> panels_;         ///< ceil(M / 16) panels of D x 16, zero where there is no descriptor.
  std::vector<float> squared_norms_;  ///< Infinity where there is no descriptor.
};

}  // namespace fabloop
