// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_closer.h"

#include <gtest/gtest.h>

#include <string>

#include "frontend/error.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"

namespace fabloop {
namespace {

using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::Walk;

LoopCloserOptions walk_options() {
  LoopCloserOptions options;
  options.hypotheses.num_recent_excluded = 10;
  options.hypotheses.max_hypotheses = 2;
  options.num_threads = 1;
  return options;
}

std::vector<LoopEvent> close_loops(const Walk& walk, const LoopCloserOptions& options) {
  LoopCloser closer(test_camera(), walk.model, options);
  std::vector<LoopEvent> events;
  for (std::size_t i = 0; i < walk.features.size(); ++i) {
    // Frames are numbered by the host, not by the closer.
    events.push_back(closer.add_keyframe({100 + i, walk.features[i], walk.world_from_camera[i]}));
  }
  EXPECT_EQ(closer.views().size(), walk.features.size());
  return events;
}

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

TEST(LoopCloser, TheSameForAnyNumberOfThreads) {
  const Walk walk = make_walk({.num_landmarks = 2000});
  LoopCloserOptions more_threads = walk_options();
  more_threads.num_threads = 3;
  const auto a = close_loops(walk, walk_options());
  const auto b = close_loops(walk, more_threads);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].hypotheses.size(), b[i].hypotheses.size());
    for (std::size_t k = 0; k < a[i].hypotheses.size(); ++k) {
      EXPECT_EQ(a[i].hypotheses[k].verification.verdict, b[i].hypotheses[k].verification.verdict);
      EXPECT_EQ(a[i].hypotheses[k].verification.match_from_query.translation,
                b[i].hypotheses[k].verification.match_from_query.translation);
    }
  }
}

TEST(LoopCloser, FeaturesOfAnotherKindAreRefused) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloser closer(test_camera(), walk.model);
  Features orb = walk.features.front();
  orb.descriptor_kind = DescriptorKind::Orb;
  try {
    closer.add_keyframe({0, orb, {}});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("orb"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("sift"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(closer.views().empty());
}

}  // namespace
}  // namespace fabloop
