// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// No Eigen here, nor in what includes this: its functions are compiled for several processors, and inline functions of a header
// would be too.
#include <cstddef>
#include <cstdint>

#include "verification/pose/five_point.h"

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
/// Compiled anew wherever it is called, for the processor of the caller.
#define FABLOOP_INLINE static inline __attribute__((always_inline))

namespace fabloop {

constexpr std::size_t kLanes = kFivePointLanes;

/// One double a lane; GCC and Clang map it to whatever vectors the processor has.
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef std::int64_t LaneMask __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

}  // namespace fabloop
// NOLINTEND(cppcoreguidelines-pro-bounds-*)
