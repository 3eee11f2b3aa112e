// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fabloop {

/// `wanted` different numbers of [0, count), ascending, all equally likely to be chosen; all of them when `wanted` is as
/// large. The same for the same seed with every compiler.
std::vector<std::size_t> sample_without_replacement(std::size_t count, std::size_t wanted, std::uint64_t seed);

/// The numbers of [0, count) in random order. The same for the same seed with every compiler.
std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed);

}  // namespace fabloop
