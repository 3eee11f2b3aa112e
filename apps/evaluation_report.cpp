// SPDX-License-Identifier: BSD-3-Clause
#include "apps/evaluation_report.h"

#include <iomanip>
#include <sstream>

namespace fabloop::apps {
namespace {

using nlohmann::ordered_json;

void print_rpe(std::ostream& out, const ordered_json& rpe, const std::string& name) {
  if (rpe.is_null()) return;
  out << "  RPE " << name << "  rmse " << rpe["translation_m"]["rmse"].get<double>() << " m, "
      << rpe["rotation_deg"]["rmse"].get<double>() << " deg (" << rpe["translation_m"]["count"] << " stretches)\n";
}

}  // namespace

void print_trajectory(std::ostream& out, const std::string& name, const ordered_json& result) {
  out << name << '\n';
  const ordered_json& ate = result["ate_m"];
  if (ate.is_null()) {
    out << "  ATE  not defined: fewer than 3 poses at times of the reference, or all in one place\n";
    return;
  }
  out << "  ATE  rmse " << ate["rmse"].get<double>() << " m, mean " << ate["mean"].get<double>() << ", median "
      << ate["median"].get<double>() << ", max " << ate["max"].get<double>() << " (" << ate["count"] << " of " << result["poses"]
      << " poses, aligned by " << result["alignment"].get<std::string>();
  if (result.contains("scale")) out << ", scale " << result["scale"].get<double>();
  out << ")\n";
  print_rpe(out, result["rpe_per_step"], "per step");
  std::ostringstream distance;
  distance << "per " << result["rpe_distance_m"].get<double>() << " m";
  print_rpe(out, result["rpe_over_distance"], distance.str());
  if (result.contains("repeat_with")) out << "  repeat with: " << result["repeat_with"].get<std::string>() << '\n';
}

void print_points(std::ostream& out, const ordered_json& result) {
  out << "points, against where the reference's cameras see them\n";
  const auto print = [&](const char* name, const ordered_json& errors) {
    out << "  " << name << "  median " << errors["median"].get<double>() << " m, rmse " << errors["rmse"].get<double>()
        << ", max " << errors["max"].get<double>() << " (" << errors["count"] << " points)\n";
  };
  print("across", result["across_m"]);
  print("height", result["height_m"]);
}

void print_loops(std::ostream& out, const ordered_json& result) {
  out << "loops.csv\n  accepted " << result["accepted"] << " of " << result["hypotheses"] << " hypotheses ("
      << result["with_scale"] << " with scale): " << result["true"] << " true, " << result["false"] << " false, "
      << result["unjudged"] << " not judged\n";
  if (!result["precision"].is_null()) out << "  precision " << result["precision"].get<double>() << '\n';
  if (!result["query_recall"].is_null()) out << "  query recall " << result["query_recall"].get<double>() << '\n';
  if (!result["pair_recall"].is_null()) out << "  pair recall " << result["pair_recall"].get<double>() << '\n';
  for (const ordered_json& loop : result["false_loops"]) {
    out << "  " << loop["query"] << " - " << loop["match"] << ' ' << loop["why"].get<std::string>() << ", "
        << loop["rotation_error_deg"].get<double>() << " deg, " << loop["translation_error_m"].get<double>() << " m\n";
  }
  out << "  recipe: " << result["recipe"].get<std::string>() << '\n';
}

void print_without_stages(std::ostream& out, const ordered_json& result) {
  if (result.empty()) return;
  out << "the same map without stages (see trajectory.tum for the one with all)\n";
  for (const ordered_json& without : result) {
    out << "  " << std::left << std::setw(20) << without["name"].get<std::string>() << std::right << "ATE rmse ";
    if (without["ate_m"].is_null()) out << "not defined";
    if (!without["ate_m"].is_null()) out << without["ate_m"]["rmse"].get<double>() << " m";
    out << ", " << without["loops"] << " loops: " << without["note"].get<std::string>() << '\n';
  }
}

}  // namespace fabloop::apps
