// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"
#include "verification/loop_closer.h"
#include "verification/map/keyframe_map_file.h"

namespace fabloop::testing_support {

inline constexpr std::size_t kNumFrames = 12;  // mapped here

inline const Walk& short_walk() {
  static const Walk walk = make_walk({.num_landmarks = 3000, .num_frames = 36, .num_again = 0});
  return walk;
}

inline LoopCloserOptions on_body_options() {
  LoopCloserOptions result;
  result.hypotheses.max_hypotheses = 1;
  result.num_threads = 1;
  result.body_from_camera = {rotation_from_vector({0.1, 0.2, 0.3}), {1, 2, 3}};
  return result;
}

inline Keyframe body_frame(std::size_t i) {
  Keyframe keyframe = keyframe_of(short_walk(), i);
  keyframe.odom_from_body = keyframe.odom_from_body * on_body_options().body_from_camera.inverse();
  if (i % 2 == 1) keyframe.step_covariance = 0.01 * static_cast<double>(i) * Eigen::Matrix<double, 6, 6>::Identity();
  return keyframe;
}

inline void expect_equal(const View& a, const View& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.height_above_ground, b.height_above_ground);
  EXPECT_EQ(a.features.descriptor_kind, b.features.descriptor_kind);
  EXPECT_EQ(a.features.pixel_size, b.features.pixel_size);
  ASSERT_EQ(a.features.keypoints.size(), b.features.keypoints.size());
  for (std::size_t i = 0; i < a.features.keypoints.size(); ++i) {
    const cv::KeyPoint &k = a.features.keypoints[i], &l = b.features.keypoints[i];
    EXPECT_TRUE(k.pt == l.pt && k.size == l.size && k.angle == l.angle && k.response == l.response && k.octave == l.octave &&
                k.class_id == l.class_id);
    EXPECT_EQ(a.rays[i], b.rays[i]);
    EXPECT_EQ(a.points_in_camera[i], b.points_in_camera[i]);
    EXPECT_EQ(a.point_weights[i], b.point_weights[i]);
  }
  EXPECT_EQ(a.features.descriptors.type(), b.features.descriptors.type());
  EXPECT_EQ(cv::norm(a.features.descriptors, b.features.descriptors, cv::NORM_INF), 0.0);
}

inline void expect_equal(const KeyframeMap& a, const KeyframeMap& b) {
  EXPECT_EQ(a.model_hash, b.model_hash);
  ASSERT_EQ(a.sessions.size(), b.sessions.size());
  for (std::size_t i = 0; i < a.sessions.size(); ++i) {
    EXPECT_EQ(a.sessions[i].camera.cx, b.sessions[i].camera.cx);
    EXPECT_EQ(a.sessions[i].camera.distortion, b.sessions[i].camera.distortion);
    EXPECT_EQ(a.sessions[i].body_from_camera.translation, b.sessions[i].body_from_camera.translation);
    EXPECT_EQ(a.sessions[i].body_from_camera.rotation.coeffs(), b.sessions[i].body_from_camera.rotation.coeffs());
  }
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const MapKeyframe &k = a.keyframes[i], &l = b.keyframes[i];
    EXPECT_EQ(k.session, l.session);
    EXPECT_EQ(k.time_ns, l.time_ns);
    EXPECT_EQ(k.odom_from_body.translation, l.odom_from_body.translation);
    EXPECT_EQ(k.odom_from_body.rotation.coeffs(), l.odom_from_body.rotation.coeffs());
    EXPECT_EQ(k.step_covariance, l.step_covariance);
    EXPECT_EQ(k.words.words, l.words.words);
    expect_equal(k.view, l.view);
  }
}

/// A map file of the walk in a folder of its own.
class MapFile : public testing::Test {
 protected:
  /// The first `num_frames` of the walk, each written as it came.
  LoopCloser mapped(std::size_t num_frames) {
    LoopCloser closer(test_camera(), short_walk().model, on_body_options());
    KeyframeMapFile file = KeyframeMapFile::create(path_, closer.map());
    for (std::size_t i = 0; i < num_frames; ++i) file.put(closer.map(), closer.add_keyframe(body_frame(i)).changed);
    return closer;
  }
  std::string message_of_reading(const std::filesystem::path& path, const Model& model = short_walk().model) {
    return test::message_of<InputError>([&] { read_keyframe_map(path, model); });
  }

  test::ScratchFolder scratch_;
  std::filesystem::path path_ = scratch_.path() / "site.map";
};

}  // namespace fabloop::testing_support
