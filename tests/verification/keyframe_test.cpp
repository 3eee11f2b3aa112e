// SPDX-License-Identifier: BSD-3-Clause
#include "verification/keyframe.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "frontend/error.h"
#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::test_camera;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kStepSigma = 0.02;

/// Three features at known pixels.
Keyframe keyframe_of_three() {
  Keyframe keyframe;
  keyframe.frame = 12;
  keyframe.features.emplace();
  keyframe.features->keypoints = {{{100.2F, 50.4F}, 3}, {{319.6F, 240.0F}, 3}, {{10.0F, 400.0F}, 3}};
  keyframe.features->descriptors = cv::Mat::ones(3, 8, CV_32F);
  return keyframe;
}

Keyframe keyframe_of_image() {
  Keyframe keyframe;
  keyframe.frame = 12;
  keyframe.image = cv::Mat::zeros(test_camera().height, test_camera().width, CV_8UC1);
  return keyframe;
}

struct Refusal {
  const char* says;  ///< What the message names besides the keyframe.
  std::function<void(Keyframe&)> spoil;
};

void expect_refused(const Keyframe& sound, const Refusal& refusal) {
  Keyframe keyframe = sound;
  refusal.spoil(keyframe);
  try {
    validate(keyframe, test_camera(), DescriptorKind::Sift);
    ADD_FAILURE() << "not refused: " << refusal.says;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("keyframe 12: "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(refusal.says), std::string::npos) << error.what();
  }
}

TEST(Keyframe, SoundOnesPass) {
  EXPECT_NO_THROW(validate(keyframe_of_three(), test_camera(), DescriptorKind::Sift));
  EXPECT_NO_THROW(validate(keyframe_of_image(), test_camera(), DescriptorKind::Sift));
  Keyframe dark;  // an image without texture has no features
  dark.features.emplace();
  EXPECT_NO_THROW(validate(dark, test_camera(), DescriptorKind::Sift));
}

TEST(Keyframe, EveryInconsistencyOfFeaturesIsRefused) {
  const std::vector<Refusal> refusals = {
      {"neither an image nor features", [](Keyframe& k) { k.features.reset(); }},
      {"an image and features", [](Keyframe& k) { k.image = keyframe_of_image().image; }},
      {"3 keypoints and 2 descriptors", [](Keyframe& k) { k.features->descriptors.pop_back(); }},
      {"sift descriptors, these are orb", [](Keyframe& k) { k.features->descriptor_kind = DescriptorKind::Orb; }},
      {"32-bit floats", [](Keyframe& k) { k.features->descriptors = cv::Mat::ones(3, 8, CV_8U); }},
      {"pixel size", [](Keyframe& k) { k.features->pixel_size = 0; }},
      {"pixel size", [](Keyframe& k) { k.features->pixel_size = kNaN; }},
      {"keypoint's pixel", [](Keyframe& k) { k.features->keypoints[1].pt.x = static_cast<float>(kNaN); }},
      {"not finite", [](Keyframe& k) { k.odom_from_body.translation.y() = kNaN; }},
      {"not finite", [](Keyframe& k) { k.odom_from_body.rotation.x() = kNaN; }},
      {"unit length", [](Keyframe& k) { k.odom_from_body.rotation.coeffs().setZero(); }},
      {"unit length", [](Keyframe& k) { k.odom_from_body.rotation.coeffs() *= 1.01; }},
      {"step_covariance", [](Keyframe& k) { k.step_covariance = -Eigen::Matrix<double, 6, 6>::Identity(); }},
      {"2 points and 3 features", [](Keyframe& k) { k.points_in_camera.resize(2); }},
      {"not finite",
       [](Keyframe& k) {
         k.points_in_camera = {{}, Eigen::Vector3d(0, 0, kNaN), {}};
       }},
      {"camera's own centre",
       [](Keyframe& k) {
         k.points_in_camera = {{}, {}, Eigen::Vector3d(0, 0, 0)};
       }},
  };
  for (const Refusal& refusal : refusals) expect_refused(keyframe_of_three(), refusal);
}

TEST(Keyframe, EveryInconsistencyOfImagesIsRefused) {
  const std::vector<Refusal> refusals = {
      {"8-bit grey", [](Keyframe& k) { k.image = cv::Mat::zeros(k.image.size(), CV_8UC3); }},
      {"resize the image", [](Keyframe& k) { k.image = k.image(cv::Rect(0, 0, 100, 80)); }},
      {"no features that they could belong to", [](Keyframe& k) { k.points_in_camera.resize(3); }},
      {"points and a depth image",
       [](Keyframe& k) { k.points_in_camera.resize(3), k.depth = cv::Mat::ones(k.image.size(), CV_32F); }},
      {"CV_16UC1", [](Keyframe& k) { k.depth = cv::Mat::ones(k.image.size(), CV_8U); }},
      {"resize the depth image", [](Keyframe& k) { k.depth = cv::Mat::ones(3, 4, CV_32F); }},
      {"depth_unit_m", [](Keyframe& k) { k.depth = cv::Mat::ones(k.image.size(), CV_16U), k.depth_unit_m = 0; }},
      {"depth_unit_m", [](Keyframe& k) { k.depth = cv::Mat::ones(k.image.size(), CV_16U), k.depth_unit_m = kNaN; }},
      {"height above ground", [](Keyframe& k) { k.height_above_ground = 0; }},
      {"height above ground", [](Keyframe& k) { k.height_above_ground = kNaN; }},
  };
  for (const Refusal& refusal : refusals) expect_refused(keyframe_of_image(), refusal);
}

TEST(Keyframe, DepthIsLookedUpAtTheNearestPixel) {
  Keyframe keyframe = keyframe_of_three();
  keyframe.depth = cv::Mat::zeros(test_camera().height, test_camera().width, CV_32F);
  keyframe.depth.at<float>(50, 100) = 7.5F;
  keyframe.depth.at<float>(240, 320) = static_cast<float>(kNaN);
  const View view = view_of(keyframe, test_camera(), *keyframe.features, kStepSigma);
  ASSERT_TRUE(view.points_in_camera[0].has_value());
  EXPECT_DOUBLE_EQ(view.points_in_camera[0]->z(), 7.5) << "depth is along the optical axis";
  EXPECT_LT(angle_between(*view.points_in_camera[0], view.rays[0]), 1e-12);
  EXPECT_FALSE(view.points_in_camera[1].has_value()) << "not finite";
  EXPECT_FALSE(view.points_in_camera[2].has_value()) << "zero";
}

TEST(Keyframe, DepthInUnitsIsTheSameAsInMetres) {
  Keyframe in_metres = keyframe_of_three();
  in_metres.depth = cv::Mat(test_camera().height, test_camera().width, CV_32F, cv::Scalar(2.0));
  Keyframe in_units = keyframe_of_three();
  in_units.depth = cv::Mat(test_camera().height, test_camera().width, CV_16U, cv::Scalar(10000));
  in_units.depth_unit_m = 0.0002;
  const View a = view_of(in_metres, test_camera(), *in_metres.features, kStepSigma);
  const View b = view_of(in_units, test_camera(), *in_units.features, kStepSigma);
  EXPECT_EQ(count_points(a), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((*a.points_in_camera[i] - *b.points_in_camera[i]).norm(), 1e-9);
}

TEST(Keyframe, ThePixelsAtTheBorderHaveADepthToo) {
  Keyframe keyframe = keyframe_of_three();
  const auto right = static_cast<float>(test_camera().width), bottom = static_cast<float>(test_camera().height);
  keyframe.features->keypoints = {{{-0.4F, -0.4F}, 3}, {{right - 0.6F, bottom - 0.6F}, 3}, {{right - 0.4F, bottom - 0.4F}, 3}};
  keyframe.depth = cv::Mat(test_camera().height, test_camera().width, CV_32F, cv::Scalar(2.0));
  EXPECT_EQ(count_points(view_of(keyframe, test_camera(), *keyframe.features, kStepSigma)), 3U);
}

TEST(Keyframe, PointsOfAnotherFrameAreRefused) {
  Keyframe keyframe = keyframe_of_three();
  const View view = view_of(keyframe, test_camera(), *keyframe.features, kStepSigma);
  keyframe.points_in_camera = {5.0 * view.rays[0], std::nullopt, 9.0 * view.rays[2]};
  const View with_points = view_of(keyframe, test_camera(), *keyframe.features, kStepSigma);
  EXPECT_EQ(*with_points.points_in_camera[0], *keyframe.points_in_camera[0]);
  EXPECT_FALSE(with_points.points_in_camera[1].has_value());

  const Pose world_from_camera{rotation_from_vector({1.2, 0.1, 0.4}), {3, 1, 2}};
  for (auto& point : keyframe.points_in_camera) {
    if (point) point = world_from_camera * *point;
  }
  try {
    view_of(keyframe, test_camera(), *keyframe.features, kStepSigma);
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("camera's frame"), std::string::npos) << error.what();
  }
}

TEST(Keyframe, BetterPointsWeighMore) {
  Keyframe keyframe = keyframe_of_three();
  keyframe.depth = cv::Mat(test_camera().height, test_camera().width, CV_32F, cv::Scalar(2.0));
  const View good = view_of(keyframe, test_camera(), *keyframe.features, 0.01);
  const View bad = view_of(keyframe, test_camera(), *keyframe.features, 0.02);
  EXPECT_NEAR(good.point_weights[0], 4.0 * bad.point_weights[0], 1e-12) << "by the inverse variance";
}

}  // namespace
}  // namespace fabloop
