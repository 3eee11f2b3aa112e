// SPDX-License-Identifier: BSD-3-Clause
#include "apps/run_report.h"

#include <iomanip>
#include <iostream>

#include "posegraph/run/run_folder.h"

namespace fabloop::apps {

Warn make_warn(const CommonOptions& common) {
  if (common.quiet) return {};
  return [](const std::string& message) { std::cerr << "note: " << message << '\n'; };
}

void print_run_report(std::ostream& out, const Sequence& sequence, const SequenceMap& result, const std::string& folder) {
  const LoopCounts loops = count_loops(result.map);
  const RunErrors errors = run_errors(sequence, result.map);
  out << "frames:      " << result.map.graph.vertices.size() << " of " << sequence.frames.size() << " mapped";
  if (result.num_damaged > 0) out << ", " << result.num_damaged << " damaged";
  if (result.map.num_without_odometry > 0) out << ", " << result.map.num_without_odometry << " without odometry";
  out << "\nhypotheses:  " << loops.num_hypotheses << " verified, " << loops.num_accepted << " loops accepted ("
      << loops.num_with_scale << " with scale)";
  if (loops.num_into_earlier > 0) out << ", " << loops.num_into_earlier << " of them into the earlier map";
  out << '\n' << "graph:       " << result.map.report.brief() << '\n';
  if (errors.odometry && errors.final) {
    const double before = errors.odometry->translation_m.rmse;
    const double after = errors.final->translation_m.rmse;
    out << std::fixed << std::setprecision(2) << "ATE:         " << before << " m odometry -> " << after << " m (";
    if (before >= after) {
      out << before / after << " times less)\n" << std::defaultfloat;
    } else {
      out << after / before << " times as much)\n" << std::defaultfloat;
    }
  }
  out << "look at:     " << folder << "/map.png, " << folder << "/summary.json\n";
}

}  // namespace fabloop::apps
