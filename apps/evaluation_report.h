// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

namespace fabloop::apps {

/// What `evaluate --json` says of a run, for readers: a trajectory by its file's name, the points of a map from images, the
/// loops, and the map without some stages.
void print_trajectory(std::ostream& out, const std::string& name, const nlohmann::ordered_json& result);
void print_points(std::ostream& out, const nlohmann::ordered_json& result);
void print_loops(std::ostream& out, const nlohmann::ordered_json& result);
void print_without_stages(std::ostream& out, const nlohmann::ordered_json& result);

}  // namespace fabloop::apps
