// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/other_cameras.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fabloop {
namespace {

bool is_same_camera(const CameraLabel& a, const CameraLabel& b) {
  constexpr double kSameFocal = 0.02;
  if (a.make != b.make || a.model != b.model) return false;
  return !a.focal_mm || !b.focal_mm || std::abs(*a.focal_mm / *b.focal_mm - 1.0) <= kSameFocal;
}

struct CameraGroup {
  CameraLabel label;  ///< Of its first image.
  std::vector<std::size_t> images;
};

}  // namespace

std::vector<std::optional<std::string>> other_cameras(const std::vector<std::optional<CameraLabel>>& labels) {
  std::vector<std::optional<std::string>> why(labels.size());
  std::vector<CameraGroup> groups;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!labels[i]) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return is_same_camera(g.label, *labels[i]); });
    if (group == groups.end()) group = groups.insert(groups.end(), {*labels[i], {}});
    group->images.push_back(i);
  }
  const auto most = std::max_element(groups.begin(), groups.end(),
                                     [](const auto& a, const auto& b) { return a.images.size() < b.images.size(); });
  for (auto group = groups.begin(); group != groups.end(); ++group) {
    if (group == most) continue;
    for (const std::size_t i : group->images) {
      why[i] = "was taken by another camera (" + to_string(group->label) + ") than most (" + to_string(most->label) +
               "): a map knows one camera; map each camera's images for themselves";
    }
  }
  return why;
}

std::vector<std::optional<std::string>> other_cameras(const Sequence& sequence) {
  std::vector<std::optional<CameraLabel>> labels;
  for (const Frame& frame : sequence.frames) labels.push_back(camera_label_from_exif(frame.image_path));
  return other_cameras(labels);
}

}  // namespace fabloop
