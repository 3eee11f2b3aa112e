// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/visit_counts.h"

namespace fabloop {

Counts counts_of(const DetectorModel& detector, std::uint32_t visits, std::uint32_t detections) {
  return {visits, detections, presence_factor(detector, visits, detections), presence_factor(detector, visits, 0)};
}

std::uint32_t VisitCounts::id(std::uint32_t visits, std::uint32_t detections) {
  const auto [entry, is_new] = ids_.try_emplace({visits, detections}, static_cast<std::uint32_t>(counts_.size()));
  if (is_new) counts_.push_back(counts_of(detector_, visits, detections));
  return entry->second;
}

}  // namespace fabloop
