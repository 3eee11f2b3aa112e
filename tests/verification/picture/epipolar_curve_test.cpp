// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/epipolar_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace fabloop {
namespace {

constexpr double kStepPx = 4.5;  ///< The curve's points are some four pixels apart along it.

Camera bent_camera() { return {640, 480, 400, 400, 319.5, 239.5, DistortionModel::Radtan, {-0.25, 0.06, 0, 0, 0}}; }
Camera fisheye_camera() { return {640, 480, 300, 300, 319.5, 239.5, DistortionModel::Equidistant, {0.02, 0, 0, 0}}; }

double distance_to(const std::vector<std::vector<cv::Point2f>>& pieces, const Eigen::Vector2d& pixel) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& piece : pieces) {
    for (std::size_t i = 0; i + 1 < piece.size(); ++i) {
      const Eigen::Vector2d from(piece[i].x, piece[i].y), along = Eigen::Vector2d(piece[i + 1].x, piece[i + 1].y) - from;
      const double share = std::clamp((pixel - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (pixel - from - share * along).norm());
    }
  }
  return least;
}

TEST(EpipolarCurve, PassesThroughThePointAtEveryDepth) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int num_seen = 0;
  for (const Camera& camera : {bent_camera(), fisheye_camera()}) {
    for (int trial = 0; trial < 30; ++trial) {
      const Eigen::Vector3d axis(uniform(random), uniform(random), uniform(random));
      const Pose b_from_a{rotation_from_vector(0.4 * axis), {uniform(random), uniform(random), uniform(random)}};
      const Eigen::Vector3d ray = Eigen::Vector3d(0.6 * uniform(random), 0.5 * uniform(random), 1).normalized();
      const auto pieces = epipolar_curve(ray, b_from_a, camera);
      for (const double depth : {1.5, 3.0, 10.0, 1000.0}) {
        const auto pixel = project(camera, b_from_a * Eigen::Vector3d(depth * ray));
        if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > 639 || pixel->y() > 479) continue;
        ++num_seen;
        EXPECT_LT(distance_to(pieces, *pixel), 0.05) << trial << ", " << depth;  // a chord of four pixels of a bent curve
      }
    }
  }
  EXPECT_GT(num_seen, 100);
}

TEST(EpipolarCurve, StaysAboutTheImageInSmallSteps) {
  const auto pieces = epipolar_curve(Eigen::Vector3d::UnitZ(), {Eigen::Quaterniond::Identity(), {1, 0.3, 0.1}}, bent_camera());
  ASSERT_FALSE(pieces.empty());
  for (const auto& piece : pieces) {
    for (std::size_t i = 0; i < piece.size(); ++i) {
      EXPECT_TRUE(cv::Rect2f(-10, -10, 660, 500).contains(piece[i])) << piece[i];
      if (i == 0) continue;
      EXPECT_LT(cv::norm(piece[i] - piece[i - 1]), 2 * kStepPx);
    }
  }
}

TEST(EpipolarCurve, OfAPureRotationIsNone) {
  EXPECT_TRUE(
      epipolar_curve(Eigen::Vector3d::UnitZ(), {rotation_from_vector({0.1, 0, 0}), Eigen::Vector3d::Zero()}, bent_camera())
          .empty());
}

}  // namespace
}  // namespace fabloop
