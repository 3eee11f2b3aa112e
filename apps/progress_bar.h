// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "apps/command.h"
#include "frontend/progress.h"

namespace fabloop::apps {

/// Shows how far long work is, on stderr: a bar with rate and time left on a terminal, an occasional plain line elsewhere,
/// nothing with `--quiet`. Give one to each run of a command.
Progress make_progress(const CommonOptions& common);

}  // namespace fabloop::apps
