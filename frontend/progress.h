// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace fabloop {

/// Called from long work with the name of the stage and how much of it is done, from one thread at a time.
using Progress = std::function<void(std::string_view stage, std::size_t done, std::size_t total)>;

/// Called with one line about something that a user should know but that does not stop the work.
using Warn = std::function<void(const std::string& message)>;

}  // namespace fabloop
