// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_kind.h"

#include <array>
#include <cassert>
#include <opencv2/core.hpp>

#include "frontend/error.h"

namespace fabloop {
namespace {

struct DetectorEntry {
  DetectorKind kind;
  std::string_view name;
  DescriptorKind default_descriptor;
};

constexpr std::array<DetectorEntry, 11> kDetectors{{{DetectorKind::Sift, "sift", DescriptorKind::Sift},
                                                    {DetectorKind::Surf, "surf", DescriptorKind::Surf},
                                                    {DetectorKind::Star, "star", DescriptorKind::Surf},
                                                    {DetectorKind::Mser, "mser", DescriptorKind::Sift},
                                                    {DetectorKind::Orb, "orb", DescriptorKind::Orb},
                                                    {DetectorKind::Brisk, "brisk", DescriptorKind::Brisk},
                                                    {DetectorKind::Akaze, "akaze", DescriptorKind::Akaze},
                                                    {DetectorKind::Kaze, "kaze", DescriptorKind::Kaze},
                                                    {DetectorKind::Fast, "fast", DescriptorKind::Brisk},
                                                    {DetectorKind::Agast, "agast", DescriptorKind::Orb},
                                                    {DetectorKind::Gftt, "gftt", DescriptorKind::Sift}}};

struct DescriptorEntry {
  DescriptorKind kind;
  std::string_view name;
  DescriptorLayout layout;
};

constexpr std::array<DescriptorEntry, 6> kDescriptors{{{DescriptorKind::Sift, "sift", {128, CV_32F}},
                                                       {DescriptorKind::Surf, "surf", {64, CV_32F}},
                                                       {DescriptorKind::Orb, "orb", {32, CV_8U}},
                                                       {DescriptorKind::Brisk, "brisk", {64, CV_8U}},
                                                       {DescriptorKind::Akaze, "akaze", {61, CV_8U}},
                                                       {DescriptorKind::Kaze, "kaze", {64, CV_32F}}}};

const DetectorEntry& entry_of(DetectorKind kind) {
  for (const DetectorEntry& entry : kDetectors) {
    if (entry.kind == kind) return entry;
  }
  assert(false && "a DetectorKind without a name");
  return kDetectors.front();
}

const DescriptorEntry& entry_of(DescriptorKind kind) {
  for (const DescriptorEntry& entry : kDescriptors) {
    if (entry.kind == kind) return entry;
  }
  assert(false && "a DescriptorKind without a name");
  return kDescriptors.front();
}

template <typename Entries>
const typename Entries::value_type* find_name(const Entries& entries, std::string_view name) {
  for (const auto& entry : entries) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

template <typename Entries>
std::string joined_names(const Entries& entries) {
  std::string text;
  for (const auto& entry : entries) text += (text.empty() ? "" : ", ") + std::string(entry.name);
  return text;
}

}  // namespace

DescriptorLayout descriptor_layout(DescriptorKind kind) { return entry_of(kind).layout; }

std::string_view to_string(DetectorKind kind) { return entry_of(kind).name; }

std::string_view to_string(DescriptorKind kind) { return entry_of(kind).name; }

std::string to_string(const FeatureKind& kind) {
  const std::string detector(to_string(kind.detector)), descriptor(to_string(kind.descriptor));
  return detector == descriptor ? detector : detector + "+" + descriptor;
}

std::optional<FeatureKind> feature_kind_from_string(std::string_view name) {
  const std::size_t plus = name.find('+');
  const DetectorEntry* detector = find_name(kDetectors, name.substr(0, plus));
  if (!detector) return std::nullopt;
  if (plus == std::string_view::npos) return FeatureKind{detector->kind, detector->default_descriptor};
  const DescriptorEntry* descriptor = find_name(kDescriptors, name.substr(plus + 1));
  if (!descriptor) return std::nullopt;
  return FeatureKind{detector->kind, descriptor->kind};
}

void require_sensible(const FeatureKind& kind) {
  const bool is_choosy = kind.descriptor == DescriptorKind::Akaze || kind.descriptor == DescriptorKind::Kaze;
  const std::string detector(to_string(kind.detector)), descriptor(to_string(kind.descriptor));
  if (!is_choosy || detector == descriptor) return;
  throw InputError("features " + to_string(kind) + ": " + descriptor +
                   " describes in the scale space of its own detector only; give " + descriptor + ", or " + detector +
                   " with sift, surf, orb or brisk (" + detector + "+sift)");
}

std::vector<FeatureKind> default_feature_kinds() {
  std::vector<FeatureKind> kinds;
  for (const DetectorEntry& entry : kDetectors) kinds.push_back({entry.kind, entry.default_descriptor});
  return kinds;
}

std::string detector_names() { return joined_names(kDetectors); }

std::string descriptor_names() { return joined_names(kDescriptors); }

}  // namespace fabloop
