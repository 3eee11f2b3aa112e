// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_closer.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model_training.h"
#include "tests/verification/event_text.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"

namespace fabloop {
namespace {

using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::text_of;
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
  for (std::size_t i = 0; i < walk.features.size(); ++i) events.push_back(closer.add_keyframe(keyframe_of(walk, i)));
  EXPECT_EQ(closer.map().keyframes.size(), walk.features.size());
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
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(text_of(a[i]), text_of(b[i]));
}

TEST(LoopCloser, FeaturesOfAnotherKindAreRefused) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloser closer(test_camera(), walk.model);
  Keyframe orb = keyframe_of(walk, 0);
  orb.features->descriptor_kind = DescriptorKind::Orb;
  try {
    closer.add_keyframe(orb);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("orb"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("sift"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(closer.map().keyframes.empty());
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

TEST(LoopCloser, ARefusedKeyframeChangesNothing) {
  const Walk walk = make_walk({.num_landmarks = 2000, .num_frames = 20, .num_again = 4});
  LoopCloser spared(test_camera(), walk.model, walk_options()), bothered(test_camera(), walk.model, walk_options());
  const std::vector<std::function<void(Keyframe&)>> spoils = {
      [](Keyframe& k) { k.odom_from_body.translation.x() = std::numeric_limits<double>::quiet_NaN(); },
      [](Keyframe& k) { k.features->descriptor_kind = DescriptorKind::Orb; },
      [](Keyframe& k) { k.features->descriptors.at<float>(0, 0) = std::numeric_limits<float>::infinity(); },
      [](Keyframe& k) { k.features->descriptors = k.features->descriptors.colRange(0, 7).clone(); },
      [](Keyframe& k) { k.points_in_camera.assign(k.features->keypoints.size(), Eigen::Vector3d(1, 0, 0)); },
      [](Keyframe& k) { k.frame = 0; },
      [](Keyframe& k) { k.time_ns = -1; },
  };
  for (std::size_t i = 0; i < walk.features.size(); ++i) {
    for (const auto& spoil : spoils) {
      if (i == 0 && &spoil >= &spoils[5]) continue;  // anything may come first
      Keyframe bad = keyframe_of(walk, i);
      bad.features->descriptors = bad.features->descriptors.clone();
      spoil(bad);
      EXPECT_THROW(bothered.add_keyframe(bad), InputError);
      EXPECT_EQ(bothered.map().keyframes.size(), i);
    }
    EXPECT_EQ(text_of(spared.add_keyframe(keyframe_of(walk, i))), text_of(bothered.add_keyframe(keyframe_of(walk, i))));
  }
}

TEST(LoopCloser, KeyframesMustComeInOrder) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloser closer(test_camera(), walk.model, walk_options());
  closer.add_keyframe(keyframe_of(walk, 1));
  EXPECT_THROW(closer.add_keyframe(keyframe_of(walk, 1)), InputError) << "the same number";
  Keyframe earlier = keyframe_of(walk, 2);
  earlier.time_ns = keyframe_of(walk, 1).time_ns - 1;
  EXPECT_THROW(closer.add_keyframe(earlier), InputError) << "an earlier stamp";
  earlier.time_ns += 1;
  EXPECT_NO_THROW(closer.add_keyframe(earlier)) << "stamps of low resolution may be equal";
}

TEST(LoopCloser, KeepsNothingOfTheHostsBuffers) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloser closer(test_camera(), walk.model, walk_options());
  Keyframe keyframe = keyframe_of(walk, 0);
  keyframe.features->descriptors = keyframe.features->descriptors.clone();
  closer.add_keyframe(keyframe);
  keyframe.features->descriptors.setTo(0);
  EXPECT_EQ(cv::norm(closer.map().keyframes.front().view.features.descriptors, walk.features[0].descriptors), 0.0);
}

TEST(LoopCloser, AnImageIsWorthItsFeatures) {
  const Camera camera = scaled(test_camera(), 0.25);
  FeatureOptions features;
  features.max_features = 60;
  const FeatureExtractor extractor(features);
  std::vector<cv::Mat> images;
  for (int i = 0; i < 2; ++i) {
    images.emplace_back(camera.height, camera.width, CV_8UC1);
    cv::RNG(static_cast<std::uint64_t>(i + 1)).fill(images.back(), cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(images.back(), images.back(), {}, 1.5);
  }
  ModelTrainingOptions training;
  training.features = features;
  training.num_words = 10;
  training.num_threads = 1;
  const Model model = train_model(
                          images.size(), [&](std::size_t i) { return extractor.extract(images[i]); }, training)
                          .model;
  LoopCloser by_images(camera, model, walk_options()), by_features(camera, model, walk_options());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const LoopEvent a = by_images.add_keyframe({.frame = i, .image = images[i]});
    const LoopEvent b = by_features.add_keyframe({.frame = i, .features = extractor.extract(images[i])});
    EXPECT_EQ(text_of(a), text_of(b));
    EXPECT_GT(a.times.features_s, 0.0);
    EXPECT_EQ(b.times.features_s, 0.0);
    EXPECT_FALSE(by_images.map().keyframes.back().words.words.empty());
    EXPECT_EQ(by_images.map().keyframes.back().words.words, by_features.map().keyframes.back().words.words);
  }
}

TEST(LoopCloser, BadOptionsAreRefused) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloserOptions options;
  options.point_sigma = 0;
  EXPECT_THROW(LoopCloser(test_camera(), walk.model, options), InputError);
  options = {};
  options.motion.p_new = 2;
  EXPECT_THROW(LoopCloser(test_camera(), walk.model, options), InputError);
  options = {};
  options.body_from_camera.rotation.coeffs().setZero();
  EXPECT_THROW(LoopCloser(test_camera(), walk.model, options), InputError);
  Camera camera = test_camera();
  camera.fx = 0;
  EXPECT_THROW(LoopCloser(camera, walk.model), InputError);
}

}  // namespace
}  // namespace fabloop
