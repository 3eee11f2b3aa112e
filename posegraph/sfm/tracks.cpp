// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/tracks.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace fabloop {
namespace {

/// A match between two features, numbered through all views.
struct Link {
  float ratio = 0;
  std::size_t a = 0, b = 0;
};

/// Sets of features with at most one a view.
class FeatureSets {
 public:
  explicit FeatureSets(const std::vector<std::size_t>& num_features) {
    for (std::size_t view = 0; view < num_features.size(); ++view) {
      first_of_view_.push_back(set_of_.size());
      for (std::size_t feature = 0; feature < num_features[view]; ++feature) {
        set_of_.push_back(members_.size());
        members_.push_back({{static_cast<std::uint32_t>(view), static_cast<std::uint32_t>(feature)}});
      }
    }
  }

  std::size_t number_of(std::size_t view, int feature) const { return first_of_view_[view] + static_cast<std::size_t>(feature); }

  /// Joins the sets of two features unless a view would then have two.
  void join(std::size_t a, std::size_t b) {
    std::size_t large = set_of_[a];
    std::size_t small = set_of_[b];
    if (large == small) return;
    if (members_[large].size() < members_[small].size()) std::swap(large, small);
    Track joined;
    std::merge(members_[large].begin(), members_[large].end(), members_[small].begin(), members_[small].end(),
               std::back_inserter(joined));
    const auto same_view = [](const TrackFeature& x, const TrackFeature& y) { return x.view == y.view; };
    if (std::adjacent_find(joined.begin(), joined.end(), same_view) != joined.end()) return;
    for (const TrackFeature& member : members_[small]) set_of_[number_of(member.view, static_cast<int>(member.feature))] = large;
    members_[small].clear();
    members_[large] = std::move(joined);
  }

  std::vector<Track> take_tracks() {
    std::erase_if(members_, [](const Track& track) { return track.size() < 2; });
    return std::move(members_);
  }

 private:
  std::vector<std::size_t> first_of_view_;
  std::vector<std::size_t> set_of_;  ///< By feature.
  std::vector<Track> members_;       ///< By set.
};

}  // namespace

TrackSet build_tracks(const std::vector<std::size_t>& num_features, const std::vector<ViewPair>& pairs) {
  FeatureSets sets(num_features);
  std::vector<Link> links;
  for (const ViewPair& pair : pairs) {
    for (const Match& m : pair.inliers) {
      links.push_back({m.ratio, sets.number_of(pair.query, m.query), sets.number_of(pair.match, m.match)});
    }
  }
  std::stable_sort(links.begin(), links.end(), [](const Link& x, const Link& y) { return x.ratio < y.ratio; });
  for (const Link& link : links) sets.join(link.a, link.b);
  return index_tracks(sets.take_tracks(), num_features.size());
}

TrackSet index_tracks(std::vector<Track> tracks, std::size_t num_views) {
  TrackSet set;
  set.tracks = std::move(tracks);
  std::sort(set.tracks.begin(), set.tracks.end());
  index_views(set, num_views);
  return set;
}

void index_views(TrackSet& set, std::size_t num_views) {
  set.of_view.assign(num_views, {});
  for (std::size_t t = 0; t < set.tracks.size(); ++t) {
    for (const TrackFeature& member : set.tracks[t]) set.of_view[member.view].push_back(static_cast<std::uint32_t>(t));
  }
}

std::optional<std::size_t> position_in(const Track& track, std::size_t view) {
  const auto at = std::lower_bound(track.begin(), track.end(), view,
                                   [](const TrackFeature& member, std::size_t wanted) { return member.view < wanted; });
  if (at == track.end() || at->view != view) return std::nullopt;
  return static_cast<std::size_t>(at - track.begin());
}

}  // namespace fabloop
