// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>

#include "apps/command.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/map_sequence.h"

namespace fabloop::apps {

/// Notes on stderr, none with `--quiet`.
Warn make_warn(const CommonOptions& common);

/// What a run found, in a few lines, and where to look.
void print_run_report(std::ostream& out, const Sequence& sequence, const SequenceMap& result, const std::string& folder);

}  // namespace fabloop::apps
