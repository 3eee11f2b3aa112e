// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace fabloop {

/// A seed for one pair of frames.
std::uint64_t pair_seed(std::uint64_t seed, std::size_t query, std::size_t match);

}  // namespace fabloop
