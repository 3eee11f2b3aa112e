// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace fabloop {

/// Number of threads to use when a user asks for `requested`: all hardware threads for 0.
int resolve_num_threads(int requested);

/// Calls `body(i)` for every i in [0, count) on up to `num_threads` threads (0: all). Iterations must be independent; an
/// exception thrown by one of them is rethrown here after the others have been cancelled.
void parallel_for(std::size_t count, int num_threads, const std::function<void(std::size_t)>& body);

}  // namespace fabloop
