// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/fabmap/observation.h"

namespace fabloop {

/// What was seen at one place. With a detector model it determines p(e=1 | L) of every word.
struct PlaceModel {
  std::uint32_t visits = 0;
  std::vector<WordId> words;              ///< Words seen at some visit, ascending.
  std::vector<std::uint32_t> detections;  ///< At how many visits each of `words` was seen.
};

/// Counts one more visit.
void add_visit(PlaceModel& place, const Observation& observation);

}  // namespace fabloop
