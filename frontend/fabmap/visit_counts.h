// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "frontend/fabmap/detector_model.h"

namespace fabloop {

/// How often a place was visited and a word was seen there: with the word itself, all that the word's likelihood depends on.
struct Counts {
  std::uint32_t visits = 0;
  std::uint32_t detections = 0;
  double factor = 1.0;         ///< presence_factor() of these counts.
  double factor_unseen = 1.0;  ///< The same, had the word never been seen at these visits.
};

Counts counts_of(const DetectorModel& detector, std::uint32_t visits, std::uint32_t detections);

/// The different Counts that occur in a map, numbered, so that a word at a place is kept as one small number.
class VisitCounts {
 public:
  static constexpr std::uint32_t kOnce = 0;

  explicit VisitCounts(const DetectorModel& detector) : detector_(detector) { id(1, 1); }

  /// The number of a pair of counts; a new one if the pair was never asked for. That of one visit, one detection is kOnce.
  std::uint32_t id(std::uint32_t visits, std::uint32_t detections);

  const Counts& operator[](std::uint32_t id) const { return counts_[id]; }
  std::size_t size() const { return counts_.size(); }

 private:
  DetectorModel detector_;
  std::vector<Counts> counts_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ids_;
};

}  // namespace fabloop
