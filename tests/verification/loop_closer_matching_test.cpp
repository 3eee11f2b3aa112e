// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"
#include "verification/loop_closer.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

using testing_support::close_loops;
using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::Walk;
using testing_support::walk_options;

TEST(LoopCloserMatching, WindowsOfKeyframesTellTheLengthThatNoDepthTells) {
  const Walk walk = make_walk();
  LoopCloserOptions options = walk_options();
  options.num_neighbours = 0;  // so nothing is triangulated
  const std::vector<LoopEvent> without = close_loops(walk, options);
  options.window_size = 3;
  const std::vector<LoopEvent> with = close_loops(walk, options);
  std::size_t num_scaled = 0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_EQ(with[i].hypotheses.size(), without[i].hypotheses.size());
    for (std::size_t h = 0; h < with[i].hypotheses.size(); ++h) {
      const HypothesisOutcome& outcome = with[i].hypotheses[h];
      const Verification& found = outcome.verification;
      EXPECT_EQ(found.verdict, without[i].hypotheses[h].verification.verdict);
      EXPECT_FALSE(without[i].hypotheses[h].verification.has_scale);
      EXPECT_EQ(found.has_scale, found.num_window_inliers > 0);
      if (!found.has_scale) continue;
      ++num_scaled;
      const Pose truth = walk.world_from_camera[outcome.match - 100].inverse() * walk.world_from_camera[with[i].query - 100];
      const Eigen::Matrix<double, 6, 1> error = pose_error(found.match_from_query, truth);
      // The odds against 30 are one in 25,000 for a chi-square of 6 degrees.
      EXPECT_LT(error.dot(found.information * error), 30) << with[i].query << ' ' << outcome.match;
      EXPECT_LT(error.head<3>().norm(), 1.2) << "twice what the verifier asks of a place: 3 % of 20 m";
    }
  }
  EXPECT_GE(num_scaled, 3U);  // six frames see the start again; where they nearly coincide with it there is no length to tell
}

TEST(LoopCloserMatching, WindowsThatMeetTellNoLength) {
  const Walk walk = make_walk({.num_again = 0});
  LoopCloserOptions options = walk_options();
  options.num_neighbours = 0;
  options.window_size = 12;
  // The keyframe before is a place like any other to this recogniser, and within the query's window.
  options.propose = [](std::size_t current) {
    return current < 20 ? std::vector<Hypothesis>{} : std::vector<Hypothesis>{{static_cast<PlaceId>(current - 1), 0.5, 0.0}};
  };
  std::size_t num_accepted = 0;
  for (const LoopEvent& event : close_loops(walk, options)) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      num_accepted += outcome.verification.verdict == Verdict::Accepted;
      EXPECT_FALSE(outcome.verification.has_scale);
    }
  }
  EXPECT_GT(num_accepted, 0U);
}

TEST(LoopCloserMatching, WordsFindTheLoopsThatAllFeaturesFind) {
  const Walk walk = make_walk();
  LoopCloserOptions options = walk_options();
  const auto accepted = [&] {
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (const LoopEvent& event : close_loops(walk, options)) {
      for (const LoopClosure& loop : event.loops) pairs.emplace(loop.query, loop.match);
    }
    return pairs;
  };
  const auto by_features = accepted();
  options.verifier.match_by = MatchBy::Words;
  options.verifier.word_matching.min_matches = 0;  // words alone
  EXPECT_EQ(accepted(), by_features);
  EXPECT_GE(by_features.size(), 4U);
}

TEST(LoopCloserMatching, OnlyTheFeaturesOfAViewHaveWordsAndOnlyWhereAskedFor) {
  const Walk walk = make_walk({.num_landmarks = 2000});
  for (const MatchBy by : {MatchBy::Features, MatchBy::Words}) {
    LoopCloserOptions options = walk_options();
    options.verifier.match_by = by;
    LoopCloser closer(test_camera(), walk.model, options);
    closer.add_keyframe(keyframe_of(walk, 0));
    const MapKeyframe& keyframe = closer.map().keyframes.front();
    EXPECT_EQ(keyframe.view.words.size(), by == MatchBy::Words ? walk.features[0].keypoints.size() : 0U);
    for (const WordId word : keyframe.view.words) {
      EXPECT_TRUE(std::binary_search(keyframe.words.words.begin(), keyframe.words.words.end(), word));
    }
    // A map that was read from a file has no words of features: they are found again.
    KeyframeMap earlier = closer.map();
    for (MapKeyframe& kept : earlier.keyframes) kept.view.words.clear();
    const LoopCloser later(test_camera(), walk.model, options, earlier);
    EXPECT_EQ(later.map().keyframes.front().view.words, keyframe.view.words);
  }
}

}  // namespace
}  // namespace fabloop
