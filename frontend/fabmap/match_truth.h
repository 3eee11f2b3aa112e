// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace fabloop {

/// Whether two frames show the same place.
enum class MatchTruth : std::uint8_t {
  False,
  True,
  NotJudged,  ///< Neither right nor wrong.
};

}  // namespace fabloop
