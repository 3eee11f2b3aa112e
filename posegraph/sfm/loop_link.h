// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace fabloop {

/// An accepted loop between two frames (positions in the sequence, as PlacedImage::frame).
struct LoopLink {
  std::size_t query = 0;
  std::size_t match = 0;
};

}  // namespace fabloop
