// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>

#include "verification/ledger.h"
#include "verification/loop_event.h"

namespace fabloop::testing_support {

/// Everything that an event says but for how long it took: equal texts, equal events to the last bit.
inline std::string text_of(const LoopEvent& event) {
  std::ostringstream text;
  text.precision(17);
  text << event.query << ' ' << event.time_ns << ' ' << event.session << ' ' << event.p_new << '\n';
  write_ledger(text, event, LedgerFormat::JsonLines);
  for (const auto* loops : {&event.loops, &event.confirmed}) {
    for (const LoopClosure& loop : *loops) {
      text << loop.query << ' ' << loop.match << ' ' << loop.match_session << ' ' << loop.match_from_query.translation << ' '
           << loop.match_from_query.rotation.coeffs() << ' ' << loop.has_scale << ' ' << loop.information << ' '
           << loop.covariance << ' ' << loop.num_inliers << ' ' << loop.probability << '\n';
    }
    text << "--\n";
  }
  for (const NeighbourLink& link : event.neighbours) {
    text << link.previous << ' ' << link.previous_from_current.translation << ' ' << link.previous_from_current.rotation.coeffs()
         << ' ' << link.information << ' ' << link.num_inliers << ' ' << link.num_points << '\n';
  }
  for (const std::size_t place : event.changed) text << place << ' ';
  return text.str();
}

}  // namespace fabloop::testing_support
