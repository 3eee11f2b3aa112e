// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posegraph/mapper.h"

namespace fabloop {

/// What a map keeps, in MiB by what needs it, as a JSON object: `features`, `geometry`, `ledger`, `graph`.
std::string memory_json(const Map& map);

/// The most memory that this process has had, MiB; 0 where the system does not tell.
double peak_memory_mib();

}  // namespace fabloop
