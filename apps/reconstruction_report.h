// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>

#include "frontend/sequence/sequence.h"
#include "posegraph/sfm/reconstruct.h"

namespace fabloop::apps {

/// What structure from motion found, in a few lines, what it left out and why, and where to look.
void print_reconstruction_report(std::ostream& out, const Sequence& sequence, const Reconstructed& result,
                                 const std::string& folder);

}  // namespace fabloop::apps
