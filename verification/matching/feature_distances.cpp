// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/feature_distances.h"

#include <algorithm>
#include <vector>

#include "frontend/features/dot_products.h"

namespace fabloop {
namespace {

std::variant<PackedDescriptors, PackedBits> packed(const cv::Mat& descriptors) {
  if (descriptors.type() == CV_32F) return PackedDescriptors(descriptors);
  return PackedBits(descriptors);
}

}  // namespace

FeatureDistances::FeatureDistances(const cv::Mat& descriptors) : packed_(packed(descriptors)) {}

std::size_t FeatureDistances::stride() const {
  return std::visit([](const auto& of_kind) { return of_kind.stride(); }, packed_);
}

void FeatureDistances::operator()(const cv::Mat& queries, float* distances) const {
  if (const auto* floats = std::get_if<PackedDescriptors>(&packed_)) {
    floats->squared_distances(queries, distances);
  } else {
    std::get<PackedBits>(packed_).distances(queries, distances);
  }
}

float squared_distance_between(const Features& a, int i, const Features& b, int j) {
  const auto size = static_cast<std::size_t>(a.descriptors.cols);
  if (a.descriptors.type() == CV_32F) return squared_distance(a.descriptors.ptr<float>(i), b.descriptors.ptr<float>(j), size);
  const auto count = static_cast<float>(hamming_distance(a.descriptors.ptr(i), b.descriptors.ptr(j), size));
  return count * count;
}

float typical_squared_distance(const Features& query, const Features& match) {
  constexpr std::size_t kNumPairs = 201;
  constexpr std::size_t kStep = 2654435761;  // Knuth's multiplicative hash
  std::vector<float> distances;
  for (std::size_t i = 0; i < kNumPairs; ++i) {
    const auto q = static_cast<int>(i * query.keypoints.size() / kNumPairs);
    const auto m = static_cast<int>(i * kStep % match.keypoints.size());
    distances.push_back(squared_distance_between(query, q, match, m));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(kNumPairs / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace fabloop
