// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/model_training.h"
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

TEST(LoopCloserInput, FeaturesOfAnotherKindAreRefused) {
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

TEST(LoopCloserInput, ARefusedKeyframeChangesNothing) {
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

TEST(LoopCloserInput, KeyframesMustComeInOrder) {
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

TEST(LoopCloserInput, KeepsNothingOfTheHostsBuffers) {
  const Walk walk = make_walk({.num_landmarks = 500, .num_frames = 6, .num_again = 1});
  LoopCloser closer(test_camera(), walk.model, walk_options());
  Keyframe keyframe = keyframe_of(walk, 0);
  keyframe.features->descriptors = keyframe.features->descriptors.clone();
  closer.add_keyframe(keyframe);
  keyframe.features->descriptors.setTo(0);
  EXPECT_EQ(cv::norm(closer.map().keyframes.front().view.features.descriptors, walk.features[0].descriptors), 0.0);
}

TEST(LoopCloserInput, AnImageIsWorthItsFeatures) {
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

TEST(LoopCloserInput, BadOptionsAreRefused) {
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
