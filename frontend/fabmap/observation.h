// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace fabloop {

/// Index of a visual word in its vocabulary.
using WordId = std::uint32_t;

/// FAB-MAP's Z: which words one view shows. Ascending, no repeats.
struct Observation {
  std::vector<WordId> words;
};

}  // namespace fabloop
