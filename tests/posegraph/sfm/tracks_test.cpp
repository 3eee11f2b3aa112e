// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/tracks.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace fabloop {
namespace {

ViewPair pair_of(std::size_t query, std::size_t match, std::vector<Match> matches) {
  ViewPair pair;
  pair.query = query;
  pair.match = match;
  pair.inliers = std::move(matches);
  return pair;
}

TEST(Tracks, FollowAPointThroughViewsThatWereMatchedInTurn) {
  const TrackSet set = build_tracks({3, 3, 3}, {pair_of(1, 0, {{2, 1, 0.5F}}), pair_of(2, 1, {{0, 2, 0.5F}})});
  ASSERT_EQ(set.tracks.size(), 1U);
  EXPECT_EQ(set.tracks[0], (Track{{0, 1}, {1, 2}, {2, 0}}));
  for (const auto& of_view : set.of_view) EXPECT_EQ(of_view, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(position_in(set.tracks[0], 1), 1U);
  EXPECT_FALSE(position_in(set.tracks[0], 3));
}

TEST(Tracks, LeaveOutTheLessDistinctiveMatchThatWouldShowAPointTwiceInAView) {
  // Features 0 and 1 of view 0 end in one track through view 1 and 2; the last link, of ratio 0.8, is the wrong one.
  const TrackSet set =
      build_tracks({2, 1, 1}, {pair_of(1, 0, {{0, 0, 0.3F}}), pair_of(2, 0, {{0, 1, 0.8F}}), pair_of(2, 1, {{0, 0, 0.4F}})});
  ASSERT_EQ(set.tracks.size(), 1U);
  EXPECT_EQ(set.tracks[0], (Track{{0, 0}, {1, 0}, {2, 0}}));
}

TEST(Tracks, NeverShowAViewTwiceNorAFeatureTwiceWhateverTheMatches) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    constexpr int kFeatures = 12;
    std::vector<ViewPair> pairs;
    for (std::size_t query = 0; query < 5; ++query) {
      for (std::size_t match = 0; match < query; ++match) {
        std::vector<Match> matches;
        for (int k = 0; k < 6; ++k) {
          matches.push_back({static_cast<int>(random() % kFeatures), static_cast<int>(random() % kFeatures),
                             static_cast<float>(random() % 100) / 100.0F});
        }
        pairs.push_back(pair_of(query, match, matches));
      }
    }
    std::set<TrackFeature> seen;
    for (const Track& track : build_tracks(std::vector<std::size_t>(5, kFeatures), pairs).tracks) {
      EXPECT_GE(track.size(), 2U);
      for (std::size_t i = 0; i < track.size(); ++i) {
        EXPECT_TRUE(seen.insert(track[i]).second);
        if (i > 0) {
          EXPECT_LT(track[i - 1].view, track[i].view);
        }
      }
    }
  }
}

}  // namespace
}  // namespace fabloop
