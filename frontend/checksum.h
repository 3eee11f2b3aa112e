// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace fabloop {

/// FNV-1a (Fowler, Noll and Vo), eight bytes at a time: it finds what a crash or a bad disk leaves, not what an enemy does.
std::uint64_t checksum(std::string_view bytes);

}  // namespace fabloop
