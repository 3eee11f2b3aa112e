// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "frontend/error.h"
#include "tests/verification/event_text.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"
#include "verification/loop_closer.h"

namespace fabloop {
namespace {

using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::text_of;
using testing_support::Walk;
using testing_support::walk_options;

constexpr std::size_t kFramesOfLap = 24;

/// A lap, and some of its frames once more: the earlier session has the lap, the later one the rest.
const Walk& lap_and_more() {
  static const Walk walk = make_walk({.num_landmarks = 3000, .num_frames = kFramesOfLap, .num_again = 5});
  return walk;
}

KeyframeMap map_of_lap(const LoopCloserOptions& lap_options = walk_options()) {
  LoopCloser closer(test_camera(), lap_and_more().model, lap_options);
  for (std::size_t i = 0; i < kFramesOfLap; ++i) closer.add_keyframe(keyframe_of(lap_and_more(), i));
  return closer.map();
}

/// The later session: other numbers, stamps and odometry frame than the earlier one.
Keyframe later_frame(std::size_t i) {
  const Pose later_odom_from_world{rotation_from_vector({0, 0, 1.0}), {100, -50, 3}};
  Keyframe keyframe = keyframe_of(lap_and_more(), kFramesOfLap + i);
  keyframe.frame = i;
  keyframe.time_ns = static_cast<std::int64_t>(i);
  keyframe.odom_from_body = later_odom_from_world * keyframe.odom_from_body;
  return keyframe;
}

TEST(EarlierMap, LoopsLeadIntoItWithTheirPose) {
  // Twice what the verifier asks of a loop, as in LoopCloser's test.
  constexpr double kMaxRotationDeg = 2;
  constexpr double kMaxTranslationM = 1.2;
  LoopCloser closer(test_camera(), lap_and_more().model, walk_options(), map_of_lap());
  std::size_t num_loops = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const LoopEvent event = closer.add_keyframe(later_frame(i));
    EXPECT_EQ(event.session, 1U);
    for (const HypothesisOutcome& outcome : event.hypotheses) EXPECT_EQ(outcome.match_session, 0U);
    for (const LoopClosure& loop : event.loops) {
      ++num_loops;
      ASSERT_EQ(loop.match_session, 0U);
      const auto& poses = lap_and_more().world_from_camera;
      const Pose truth = poses[loop.match - 100].inverse() * poses[kFramesOfLap + loop.query];
      EXPECT_LT(deg_from_rad(loop.match_from_query.rotation.angularDistance(truth.rotation)), kMaxRotationDeg);
      if (!loop.has_scale) continue;
      EXPECT_LT((loop.match_from_query.translation - truth.translation).norm(), kMaxTranslationM);
    }
  }
  EXPECT_GE(num_loops, 4U);
}

TEST(EarlierMap, ItsKeyframesAreNeverNeighboursOfTheNewOnes) {
  LoopCloser closer(test_camera(), lap_and_more().model, walk_options(), map_of_lap());
  const LoopEvent first = closer.add_keyframe(later_frame(0));
  EXPECT_TRUE(first.neighbours.empty());
  EXPECT_EQ(first.changed, std::vector<std::size_t>{kFramesOfLap});
  for (const NeighbourLink& link : closer.add_keyframe(later_frame(1)).neighbours) EXPECT_EQ(link.previous, 0U);
}

TEST(EarlierMap, LeavesRoomForTheSessionsOwnPlaces) {
  LoopCloser closer(test_camera(), lap_and_more().model, walk_options(), map_of_lap());
  std::size_t num_own = 0;
  for (std::size_t i = 0; i < kFramesOfLap; ++i) {
    Keyframe keyframe = keyframe_of(lap_and_more(), i);  // the same lap once more: the earlier places look most alike
    keyframe.frame = i;
    const LoopEvent event = closer.add_keyframe(keyframe);
    const auto is_own = [](const HypothesisOutcome& outcome) { return outcome.match_session == 1; };
    num_own = static_cast<std::size_t>(std::count_if(event.hypotheses.begin(), event.hypotheses.end(), is_own));
    EXPECT_EQ(event.hypotheses.size() - num_own, walk_options().hypotheses.max_hypotheses);
  }
  EXPECT_EQ(num_own, walk_options().hypotheses.max_hypotheses);
}

TEST(EarlierMap, ItsLastKeyframesMayBeRecognisedAtOnce) {
  // With a window of recent keyframes as long as the whole map, none of the earlier session may fall into it.
  LoopCloserOptions wide = walk_options();
  wide.hypotheses.num_recent_excluded = 1000;
  wide.hypotheses.max_hypotheses = 1000;
  LoopCloser closer(test_camera(), lap_and_more().model, wide, map_of_lap());
  for (std::size_t i = 0; i < 3; ++i) {
    const LoopEvent event = closer.add_keyframe(later_frame(i));
    EXPECT_EQ(event.hypotheses.size(), kFramesOfLap);
  }
}

TEST(EarlierMap, TheWayFromItsEndToTheNewBeginningIsNoMotion) {
  // Motion has a direction-free reach of one place here, so that a map turned end to end gives the same probabilities: unless one
  // of its ends were a neighbour of the new session's first place.
  const KeyframeMap forth = map_of_lap();
  KeyframeMap back = forth;
  std::reverse(back.keyframes.begin(), back.keyframes.end());
  for (std::size_t i = 0; i < back.keyframes.size(); ++i) back.keyframes[i].view.frame = i;
  LoopCloserOptions all = walk_options();
  all.hypotheses.max_hypotheses = 1000;
  LoopCloser of_forth(test_camera(), lap_and_more().model, all, forth), of_back(test_camera(), lap_and_more().model, all, back);
  // Sums of the same terms in another order.
  constexpr double kRounding = 1e-9;
  for (std::size_t i = 0; i < 3; ++i) {
    const LoopEvent a = of_forth.add_keyframe(later_frame(i)), b = of_back.add_keyframe(later_frame(i));
    EXPECT_NEAR(a.p_new, b.p_new, kRounding);
    for (const HypothesisOutcome& outcome : a.hypotheses) {
      const std::size_t same_place = kFramesOfLap - 1 - (outcome.match - 100);
      const auto found = std::find_if(b.hypotheses.begin(), b.hypotheses.end(),
                                      [&](const HypothesisOutcome& other) { return other.match == same_place; });
      ASSERT_NE(found, b.hypotheses.end());
      EXPECT_NEAR(outcome.probability, found->probability, kRounding);
    }
  }
}

TEST(EarlierMap, LoopsWithinTheLaterSessionNameIt) {
  LoopCloser closer(test_camera(), lap_and_more().model, walk_options(), map_of_lap());
  bool has_own = false;
  for (std::size_t i = 0; i < kFramesOfLap + 4; ++i) {
    Keyframe keyframe = keyframe_of(lap_and_more(), i);
    keyframe.frame = i;
    for (const HypothesisOutcome& outcome : closer.add_keyframe(keyframe).hypotheses) {
      if (outcome.match_session == 1) {
        has_own = true;
        EXPECT_GT(i - outcome.match, walk_options().hypotheses.num_recent_excluded);
      } else {
        EXPECT_GE(outcome.match, 100U);
      }
    }
  }
  EXPECT_TRUE(has_own);
}

TEST(EarlierMap, ConsistencyHoldsAcrossSessionsToo) {
  LoopCloserOptions strict = walk_options();
  strict.consistency.num_required = 2;
  LoopCloser closer(test_camera(), lap_and_more().model, strict, map_of_lap());
  std::size_t num_loops = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const LoopEvent event = closer.add_keyframe(later_frame(i));
    EXPECT_TRUE(i >= 2 || event.loops.empty());
    num_loops += event.loops.size() + event.confirmed.size();
  }
  EXPECT_GE(num_loops, 4U);
}

TEST(EarlierMap, CamerasMayDiffer) {
  LoopCloserOptions on_a_body = walk_options();
  on_a_body.body_from_camera = {rotation_from_vector({0.3, 0.2, 0.1}), {0.5, 0, 0}};
  // The later session's camera is its body; the earlier one's sat on another.
  KeyframeMap earlier;
  {
    LoopCloser closer(test_camera(), lap_and_more().model, on_a_body);
    for (std::size_t i = 0; i < kFramesOfLap; ++i) {
      Keyframe keyframe = keyframe_of(lap_and_more(), i);
      keyframe.odom_from_body = keyframe.odom_from_body * on_a_body.body_from_camera.inverse();
      closer.add_keyframe(keyframe);
    }
    earlier = closer.map();
  }
  LoopCloser closer(test_camera(), lap_and_more().model, walk_options(), earlier);
  LoopCloser of_cameras(test_camera(), lap_and_more().model, walk_options(), map_of_lap());
  constexpr double kRounding = 1e-6;  // the same numbers in another order of operations, through RANSAC's refinement
  for (std::size_t i = 0; i < 5; ++i) {
    const LoopEvent a = closer.add_keyframe(later_frame(i)), b = of_cameras.add_keyframe(later_frame(i));
    ASSERT_EQ(a.loops.size(), b.loops.size());
    for (std::size_t k = 0; k < a.loops.size(); ++k) {
      if (!a.loops[k].has_scale) continue;
      const Pose expected = on_a_body.body_from_camera * b.loops[k].match_from_query;
      EXPECT_LT((a.loops[k].match_from_query.translation - expected.translation).norm(), kRounding);
      EXPECT_LT(a.loops[k].match_from_query.rotation.angularDistance(expected.rotation), kRounding);
    }
  }
}

TEST(EarlierMap, AnEmptyOneChangesNothing) {
  LoopCloser plain(test_camera(), lap_and_more().model, walk_options());
  LoopCloser with_empty(test_camera(), lap_and_more().model, walk_options(), KeyframeMap{});
  for (std::size_t i = 0; i < 12; ++i) {
    const Keyframe keyframe = keyframe_of(lap_and_more(), i);
    EXPECT_EQ(text_of(plain.add_keyframe(keyframe)), text_of(with_empty.add_keyframe(keyframe)));
  }
}

}  // namespace
}  // namespace fabloop
