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

bool is_smaller(const CameraGroup& a, const CameraGroup& b) { return a.images.size() < b.images.size(); }

}  // namespace

std::vector<std::optional<std::string>> other_cameras(const std::vector<std::optional<CameraLabel>>& labels) {
  std::vector<std::optional<std::string>> why(labels.size());
  std::vector<CameraGroup> groups;
  // Those that do not tell their focal length come last, to the largest group of their make and model.
  for (const bool tells_focal : {true, false}) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!labels[i] || labels[i]->focal_mm.has_value() != tells_focal) continue;
      auto chosen = groups.end();
      for (auto group = groups.begin(); group != groups.end(); ++group) {
        if (is_same_camera(group->label, *labels[i]) && (chosen == groups.end() || is_smaller(*chosen, *group))) chosen = group;
      }
      if (chosen == groups.end()) chosen = groups.insert(groups.end(), {*labels[i], {}});
      chosen->images.push_back(i);
    }
  }
  const auto most = std::max_element(groups.begin(), groups.end(), is_smaller);
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
