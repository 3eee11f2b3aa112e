// SPDX-License-Identifier: BSD-3-Clause
// Calls the installed library as a user would; exits with 0 when the results are right.
#include <cmath>
#include <iostream>
#include <opencv2/core.hpp>

#include "frontend/error.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/sequence/sequence.h"

namespace {

bool poses_cancel() {
  const fabloop::Pose a_from_b{Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {1, 2, 3}};
  return (a_from_b * a_from_b.inverse()).translation.norm() < 1e-12;
}

bool a_camera_projects() {
  fabloop::Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 500, camera.cx = 319.5, camera.cy = 239.5;
  const auto pixel = fabloop::project(camera, {0.1, 0, 1});
  return pixel && std::abs(pixel->x() - 369.5) < 1e-9;
}

bool features_are_found() {
  cv::Mat image(240, 320, CV_8UC1);
  cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 256);
  return fabloop::FeatureExtractor().extract(image).keypoints.size() > 100;
}

bool bad_input_is_named() {
  try {
    fabloop::read_sequence("no such folder");
  } catch (const fabloop::InputError& error) {
    return std::string(error.what()).find("no such folder") != std::string::npos;
  }
  return false;
}

}  // namespace

int main() {
  const bool right = poses_cancel() && a_camera_projects() && features_are_found() && bad_input_is_named();
  std::cout << (right ? "the installed library works\n" : "the installed library gives wrong results\n");
  return right ? 0 : 1;
}
