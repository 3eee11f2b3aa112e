// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <variant>

#include "frontend/features/descriptor_distances.h"
#include "frontend/features/features.h"
#include "frontend/features/hamming_distances.h"

namespace fabloop {

/// M descriptors, of floats or of bits, laid out for fast distances to many others.
class FeatureDistances {
 public:
  explicit FeatureDistances(const cv::Mat& descriptors);

  /// M rounded up to kRowStep.
  std::size_t stride() const;

  /// From each of N queries to all, into N x stride() floats: squared Euclidean distances of floats, plain Hamming distances of
  /// bits. What lies beyond M is infinity.
  void operator()(const cv::Mat& queries, float* distances) const;

 private:
  std::variant<PackedDescriptors, PackedBits> packed_;
};

/// Squared distance of feature i of a and feature j of b: Euclidean of floats, Hamming of bits.
float squared_distance_between(const Features& a, int i, const Features& b, int j);

/// What two features typically are apart that have nothing to do with each other: the median over some pairs of the two sides,
/// a few of which may be true ones by chance. Neither side is empty.
float typical_squared_distance(const Features& query, const Features& match);

}  // namespace fabloop
