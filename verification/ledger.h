// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>

#include "verification/loop_event.h"

namespace fabloop {

enum class LedgerFormat {
  Csv,        ///< The lines of `loops.csv`, below ledger_csv_head().
  JsonLines,  ///< One object a line, with the same names; numbers that are not finite are null.
};

/// The head line of `loops.csv`: `query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw`, then the
/// figures of the gates.
std::string ledger_csv_head();

/// Writes a line for each of the event's hypotheses, most probable first: the verdict with every figure that led to it. Numbers
/// come back exactly when they are read.
void write_ledger(std::ostream& out, const LoopEvent& event, LedgerFormat format);

}  // namespace fabloop
