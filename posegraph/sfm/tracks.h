// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "posegraph/sfm/view_graph.h"

namespace fabloop {

/// A feature of a view.
struct TrackFeature {
  std::uint32_t view = 0;
  std::uint32_t feature = 0;
  friend auto operator<=>(const TrackFeature&, const TrackFeature&) = default;
};

/// Features that are said to show one point, at most one a view, views ascending.
using Track = std::vector<TrackFeature>;

/// All tracks, and which of them each view shows.
struct TrackSet {
  std::vector<Track> tracks;
  std::vector<std::vector<std::uint32_t>> of_view;  ///< Positions in `tracks`, ascending.
};

/// Joins matches to tracks, the most distinctive first; a match that would give a track two features of one view is left out, so
/// that a wrong match costs a track its tail and not the whole. `num_features` is of each view.
TrackSet build_tracks(const std::vector<std::size_t>& num_features, const std::vector<ViewPair>& pairs);

/// A track set from its tracks alone.
TrackSet index_tracks(std::vector<Track> tracks, std::size_t num_views);

/// Which tracks each view shows, again after tracks have changed.
void index_views(TrackSet& set, std::size_t num_views);

/// Where in a track a view's feature stands, if the view shows it.
std::optional<std::size_t> position_in(const Track& track, std::size_t view);

}  // namespace fabloop
