// SPDX-License-Identifier: BSD-3-Clause
#include "apps/results_table.h"

#include <array>
#include <iomanip>
#include <sstream>

#include "apps/run_files.h"

namespace fabloop::apps {
namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, 7> kStages = {"read", "features", "words", "recognise", "neighbours", "verify", "optimize"};

/// "0.98", or "-" where the truth does not tell.
std::string share(const ordered_json& value) {
  if (value.is_null()) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << value.get<double>();
  return text.str();
}

std::string metres(const ordered_json& trajectories, const char* name) {
  if (!trajectories.contains(name) || trajectories[name]["ate_m"].is_null()) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << trajectories[name]["ate_m"]["rmse"].get<double>();
  return text.str();
}

}  // namespace

std::string results_head() {
  std::ostringstream text;
  text << "| sequence | frames | hypotheses | accepted | true | false | query recall | pair recall | ATE odometry [m] | ATE "
          "after [m] |";
  for (const char* stage : kStages) text << ' ' << stage << " [s] |";
  text << "\n|---|";
  for (std::size_t i = 0; i < 9 + kStages.size(); ++i) text << "---|";
  text << '\n';
  return text.str();
}

std::string results_row(const std::filesystem::path& run, const ordered_json& evaluation) {
  const ordered_json summary = read_summary(run);
  const ordered_json& loops = evaluation["loops"];
  const ordered_json& trajectories = evaluation["trajectories"];
  const double num_frames = summary["frames"]["mapped"].get<double>();
  std::ostringstream text;
  text << "| " << summary["sequence"].get<std::string>() << " | " << num_frames << " | " << loops["hypotheses"] << " | "
       << loops["accepted"] << " | " << loops["true"] << " | " << loops["false"] << " | " << share(loops["query_recall"]) << " | "
       << share(loops["pair_recall"]) << " | " << metres(trajectories, "trajectory_odometry.tum") << " | "
       << metres(trajectories, "trajectory.tum") << " |" << std::fixed << std::setprecision(3);
  for (const char* stage : kStages) text << ' ' << summary["timings"][stage]["total_s"].get<double>() / num_frames << " |";
  text << '\n';
  return text.str();
}

}  // namespace fabloop::apps
