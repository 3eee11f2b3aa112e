// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "verification/map/keyframe_map.h"

/// What stands in the rows of a keyframe map's file (private). Reading throws StateDamaged where it makes no sense.
namespace fabloop::keyframe_map_rows {

std::string row_of(const MapSession& session);
MapSession session_of(std::string_view row);

/// All of a keyframe but its session and its points.
std::string row_of(const MapKeyframe& keyframe);
/// The keyframe as a camera of its session saw it, without points.
MapKeyframe keyframe_of(std::string_view row, const Camera& camera);

/// The points that a view's features show, with their weights.
std::string points_row_of(const View& view);
void set_points(std::string_view row, View& view);

}  // namespace fabloop::keyframe_map_rows
