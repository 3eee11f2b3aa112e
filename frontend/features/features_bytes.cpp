// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/features_bytes.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace fabloop {
namespace {

/// A keypoint as it stands in the file, whatever OpenCV makes of it.
struct StoredKeypoint {
  float x, y, size, angle, response;
  std::int32_t octave, class_id;
};

}  // namespace

void put(StateBytes& bytes, const Features& features) {
  std::vector<StoredKeypoint> keypoints;
  for (const cv::KeyPoint& k : features.keypoints) {
    keypoints.push_back({k.pt.x, k.pt.y, k.size, k.angle, k.response, k.octave, k.class_id});
  }
  bytes.put(static_cast<std::int32_t>(features.descriptor_kind));
  bytes.put(features.pixel_size);
  bytes.put(keypoints);
  bytes.put(features.descriptors.empty() ? cv::Mat(0, 0, CV_8UC1) : features.descriptors);
}

Features take_features(StateBytes& bytes) {
  std::int32_t kind = 0;
  std::vector<StoredKeypoint> keypoints;
  Features features;
  bytes.take(kind);
  bytes.take(features.pixel_size);
  bytes.take(keypoints);
  bytes.take(features.descriptors);
  if (!(std::isfinite(features.pixel_size) && features.pixel_size > 0)) throw StateDamaged();
  if (kind < 0 || kind > static_cast<std::int32_t>(DescriptorKind::Kaze)) throw StateDamaged();
  features.descriptor_kind = static_cast<DescriptorKind>(kind);
  if (features.descriptors.rows != static_cast<int>(keypoints.size())) throw StateDamaged();
  for (const StoredKeypoint& k : keypoints) {
    features.keypoints.emplace_back(k.x, k.y, k.size, k.angle, k.response, k.octave, k.class_id);
  }
  return features;
}

}  // namespace fabloop
