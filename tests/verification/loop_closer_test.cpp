// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_closer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "tests/verification/event_text.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"

namespace fabloop {
namespace {

using testing_support::close_loops;
using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::text_of;
using testing_support::Walk;
using testing_support::walk_options;

TEST(LoopCloser, FindsTheRevisitWithItsPose) {
  const Walk walk = make_walk();
  // What the verifier asks of a loop: a rotation known to 1 degree, a direction to 5 degrees, a place to 3 % of the 20 m of
  // depth; twice that is allowed.
  constexpr double kMaxRotationDeg = 2;
  constexpr double kMaxDirectionDeg = 10;
  constexpr double kMaxTranslationM = 1.2;
  std::size_t num_with_scale = 0;
  for (const LoopEvent& event : close_loops(walk, walk_options())) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.verification.verdict != Verdict::Accepted) continue;
      const Pose truth = walk.world_from_camera[outcome.match - 100].inverse() * walk.world_from_camera[event.query - 100];
      const Pose& found = outcome.verification.match_from_query;
      const std::string pair = std::to_string(event.query) + " " + std::to_string(outcome.match);
      EXPECT_LT(deg_from_rad(found.rotation.angularDistance(truth.rotation)), kMaxRotationDeg) << pair;
      if (outcome.verification.has_scale) {
        ++num_with_scale;
        EXPECT_LT((found.translation - truth.translation).norm(), kMaxTranslationM) << pair;
      } else {
        EXPECT_LT(deg_from_rad(angle_between(found.translation, truth.translation)), kMaxDirectionDeg) << pair;
      }
    }
  }
  EXPECT_GE(num_with_scale, 4U);  // six frames see the start again
}

TEST(LoopCloser, RecentKeyframesAreNeverHypotheses) {
  const Walk walk = make_walk({.num_landmarks = 2000});
  for (const LoopEvent& event : close_loops(walk, walk_options())) {
    EXPECT_GE(event.p_new, 0.0);
    EXPECT_LE(event.p_new, 1.0);
    double before = 1;
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      EXPECT_GT(event.query - outcome.match, walk_options().hypotheses.num_recent_excluded);
      EXPECT_LE(outcome.probability, before) << "most probable first";
      before = outcome.probability;
    }
  }
}

TEST(LoopCloser, WhatAnotherRecogniserProposesIsVerifiedAsFabMapsPlacesAre) {
  const Walk walk = make_walk({.num_landmarks = 2000});
  const std::vector<LoopEvent> own = close_loops(walk, walk_options());
  LoopCloserOptions options = walk_options();
  options.propose = [&](std::size_t current) {
    std::vector<Hypothesis> hypotheses;
    for (const HypothesisOutcome& outcome : own[current].hypotheses) {
      hypotheses.push_back({static_cast<PlaceId>(outcome.match - 100), outcome.probability, outcome.log_likelihood});
    }
    return hypotheses;
  };
  const std::vector<LoopEvent> proposed = close_loops(walk, options);
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(text_of(proposed[i]), text_of(own[i]));
}

TEST(LoopCloser, APlaceThatIsNoEarlierKeyframeOrComesTwiceIsRefusedAndChangesNothing) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 12, .num_again = 1});
  std::vector<Hypothesis> hypotheses;
  LoopCloserOptions options = walk_options();
  options.propose = [&](std::size_t) { return hypotheses; };
  LoopCloser closer(test_camera(), walk.model, options);
  closer.add_keyframe(keyframe_of(walk, 0));
  for (const Hypothesis& bad : {Hypothesis{1, 0.5, 0.0}, Hypothesis{0, 1.5, 0.0}, Hypothesis{0, std::nan(""), 0.0}}) {
    hypotheses = {bad};
    EXPECT_THROW(closer.add_keyframe(keyframe_of(walk, 1)), InputError);
  }
  hypotheses = {{0, 0.5, 0.0}, {0, 0.4, 0.0}};
  EXPECT_THROW(closer.add_keyframe(keyframe_of(walk, 1)), InputError) << "its loop would count twice";
  EXPECT_EQ(closer.map().keyframes.size(), 1U);
  hypotheses = {{0, 0.5, 0.0}};
  EXPECT_EQ(closer.add_keyframe(keyframe_of(walk, 1)).hypotheses.size(), 1U);
}

TEST(LoopCloser, TheSameForAnyNumberOfThreads) {
  const Walk walk = make_walk({.num_landmarks = 2000});
  LoopCloserOptions more_threads = walk_options();
  more_threads.num_threads = 3;
  const auto a = close_loops(walk, walk_options());
  const auto b = close_loops(walk, more_threads);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(text_of(a[i]), text_of(b[i]));
}

TEST(LoopCloser, HandsOutExactlyTheAcceptedHypotheses) {
  const Walk walk = make_walk();
  std::size_t num_loops = 0;
  for (const LoopEvent& event : close_loops(walk, walk_options())) {
    std::vector<const HypothesisOutcome*> accepted;
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.verification.verdict == Verdict::Accepted) accepted.push_back(&outcome);
    }
    ASSERT_EQ(event.loops.size(), accepted.size());
    for (std::size_t i = 0; i < accepted.size(); ++i) {
      EXPECT_EQ(event.loops[i].query, event.query);
      EXPECT_EQ(event.loops[i].match, accepted[i]->match);
      EXPECT_EQ(event.loops[i].num_inliers, accepted[i]->verification.num_inliers);
    }
    EXPECT_TRUE(event.confirmed.empty()) << "only temporal consistency withholds loops";
    num_loops += accepted.size();
  }
  EXPECT_GE(num_loops, 4U);
}

TEST(LoopCloser, LoopsAreOfTheBodiesThatCarryTheCameras) {
  const Walk walk = make_walk();
  LoopCloserOptions options = walk_options();
  options.body_from_camera = {rotation_from_vector({0.4, -1.1, 0.3}), {0.5, -0.2, 1.5}};
  LoopCloser closer(test_camera(), walk.model, options);
  const auto of_cameras = close_loops(walk, walk_options());
  constexpr double kRounding = 1e-6;  // the same numbers in another order of operations, through RANSAC's refinement
  std::size_t num_loops = 0;
  for (std::size_t i = 0; i < walk.features.size(); ++i) {
    Keyframe keyframe = keyframe_of(walk, i);
    keyframe.odom_from_body = walk.world_from_camera[i] * options.body_from_camera.inverse();
    const LoopEvent event = closer.add_keyframe(keyframe);
    ASSERT_EQ(event.loops.size(), of_cameras[i].loops.size());
    for (std::size_t k = 0; k < event.loops.size(); ++k) {
      const LoopClosure& loop = event.loops[k];
      const LoopClosure& camera_loop = of_cameras[i].loops[k];
      const Pose& b = options.body_from_camera;
      ASSERT_TRUE(loop.has_scale);
      const Pose expected = b * camera_loop.match_from_query * b.inverse();
      EXPECT_LT((loop.match_from_query.translation - expected.translation).norm(), kRounding);
      EXPECT_LT(loop.match_from_query.rotation.angularDistance(expected.rotation), kRounding);
      ++num_loops;
    }
  }
  EXPECT_GE(num_loops, 4U);
}

TEST(LoopCloser, PointsOfTheHostGiveScaleWithoutNeighbours) {
  const Walk walk = make_walk();
  LoopCloserOptions options = walk_options();
  options.num_neighbours = 0;
  LoopCloser without(test_camera(), walk.model, options), with(test_camera(), walk.model, options);
  std::size_t num_with_scale = 0;
  for (std::size_t i = 0; i < walk.features.size(); ++i) {
    Keyframe keyframe = keyframe_of(walk, i);
    for (const LoopClosure& loop : without.add_keyframe(keyframe).loops) EXPECT_FALSE(loop.has_scale);
    keyframe.points_in_camera = walk.points_in_camera[i];
    const LoopEvent event = with.add_keyframe(keyframe);
    EXPECT_TRUE(event.neighbours.empty());
    for (const LoopClosure& loop : event.loops) num_with_scale += loop.has_scale;
  }
  EXPECT_GE(num_with_scale, 4U);  // six frames see the start again
}

TEST(LoopCloser, WithholdsLoopsUntilEnoughKeyframesAgree) {
  const Walk walk = make_walk();
  LoopCloserOptions options = walk_options();
  options.consistency.num_required = 2;
  const auto at_once = close_loops(walk, walk_options());
  const auto later = close_loops(walk, options);
  std::set<std::pair<std::size_t, std::size_t>> proven, handed_out, withheld;
  bool is_first_revisit = true;
  for (std::size_t i = 0; i < later.size(); ++i) {
    for (const LoopClosure& loop : at_once[i].loops) proven.insert({loop.query, loop.match});
    if (is_first_revisit && !at_once[i].loops.empty()) {
      EXPECT_TRUE(later[i].loops.empty());
      is_first_revisit = false;
    }
    for (const HypothesisOutcome& outcome : later[i].hypotheses) {
      if (outcome.verification.verdict == Verdict::Unconfirmed) withheld.insert({later[i].query, outcome.match});
    }
    for (const LoopClosure& loop : later[i].loops) EXPECT_TRUE(handed_out.insert({loop.query, loop.match}).second);
    for (const LoopClosure& loop : later[i].confirmed) {
      EXPECT_TRUE(withheld.contains({loop.query, loop.match})) << "was withheld before";
      EXPECT_TRUE(handed_out.insert({loop.query, loop.match}).second) << "is handed out once";
    }
  }
  EXPECT_FALSE(withheld.empty());
  EXPECT_EQ(handed_out, proven) << "right loops of a revisit of six keyframes are all confirmed in the end";
}

}  // namespace
}  // namespace fabloop
