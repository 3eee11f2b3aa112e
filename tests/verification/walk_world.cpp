// SPDX-License-Identifier: BSD-3-Clause
#include "tests/verification/walk_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frontend/fabmap/model_training.h"
#include "tests/verification/two_view_world.h"

namespace fabloop::testing_support {
namespace {

constexpr double kRadiusM = 60;
constexpr double kHeightM = 20;
constexpr int kDescriptorSize = 32;

struct Landmarks {
  std::vector<Eigen::Vector3d> positions;
  cv::Mat1f descriptors;
};

/// On rough ground in a ring below the circle.
Landmarks make_landmarks(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> angle(0, 2 * kPi), radius(kRadiusM - 15, kRadiusM + 15), height(-3, 3);
  std::normal_distribution<float> normal;
  Landmarks landmarks;
  landmarks.descriptors.create(count, kDescriptorSize);
  for (float& value : landmarks.descriptors) value = normal(random);
  for (int i = 0; i < count; ++i) {
    const double a = angle(random), r = radius(random);
    landmarks.positions.emplace_back(r * std::cos(a), r * std::sin(a), height(random));
  }
  return landmarks;
}

/// Looking down, the top of the picture to the front.
Pose pose_on_circle(double angle, double radius) {
  Eigen::Matrix3d rotation;
  const Eigen::Vector3d forward(-std::sin(angle), std::cos(angle), 0);
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  rotation << (-forward).cross(down), -forward, down;
  return {Eigen::Quaterniond(rotation), {radius * std::cos(angle), radius * std::sin(angle), kHeightM}};
}

/// Adds what is seen from a pose to the walk.
void look(std::mt19937_64& random, const Landmarks& landmarks, const Pose& world_from_camera, double noise_px, Walk& walk) {
  std::normal_distribution<double> normal(0, noise_px);
  const Camera camera = test_camera();
  const Pose camera_from_world = world_from_camera.inverse();
  Features& features = walk.features.emplace_back();
  auto& points = walk.points_in_camera.emplace_back();
  for (std::size_t i = 0; i < landmarks.positions.size(); ++i) {
    const Eigen::Vector3d x_in_camera = camera_from_world * landmarks.positions[i];
    if (x_in_camera.z() < 1) continue;
    const auto pixel = project(camera, x_in_camera);
    if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width - 1 || pixel->y() > camera.height - 1) continue;
    features.keypoints.emplace_back(static_cast<float>(pixel->x() + normal(random)),
                                    static_cast<float>(pixel->y() + normal(random)), 3.0F);
    features.descriptors.push_back(landmarks.descriptors.row(static_cast<int>(i)));
    points.emplace_back(x_in_camera);
  }
}

}  // namespace

Walk make_walk(const WalkOptions& options) {
  constexpr double kAsideM = 2;
  std::mt19937_64 random(options.seed);
  const Landmarks landmarks = make_landmarks(random, options.num_landmarks);
  Walk walk;
  for (std::size_t i = 0; i < options.num_frames + options.num_again; ++i) {
    const double angle = 2 * kPi * static_cast<double>(i) / static_cast<double>(options.num_frames);
    const bool is_again = i >= options.num_frames;
    walk.world_from_camera.push_back(pose_on_circle(angle, is_again ? kRadiusM + kAsideM : kRadiusM));
    look(random, landmarks, walk.world_from_camera.back(), options.noise_px, walk);
  }
  ModelTrainingOptions training;
  training.num_words = 200;
  training.num_threads = 1;
  walk.model = train_model(
                   walk.features.size(), [&](std::size_t i) { return walk.features[i]; }, training)
                   .model;
  return walk;
}

Keyframe keyframe_of(const Walk& walk, std::size_t i) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {.frame = 100 + i,
          .time_ns = static_cast<std::int64_t>(i) * kSecond,
          .odom_from_body = walk.world_from_camera[i],
          .features = walk.features[i]};
}

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

}  // namespace fabloop::testing_support
