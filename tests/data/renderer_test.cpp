// SPDX-License-Identifier: BSD-3-Clause
#include "data/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/photograph.h"
#include "frontend/error.h"
#include "tests/data/tiny_flight.h"

namespace fabloop {
namespace {

const SyntheticFlight& tiny_flight() {
  static const SyntheticFlight flight = make_synthetic_flight(tiny_flight_options());
  return flight;
}

Eigen::Vector3d point_in_world(const Renderer& renderer, const RenderedView& view, const Pose& world_from_camera, int col,
                               int row) {
  const Eigen::Vector3d ray = bearings(renderer.camera(), {Eigen::Vector2d(col, row)}).front();
  return world_from_camera * Eigen::Vector3d(ray * (view.depth(row, col) / ray.z()));
}

TEST(Renderer, DepthAgreesWithTheHeights) {
  const auto& flight = tiny_flight();
  const Renderer renderer(flight.world, tiny_camera());
  const Pose& pose = flight.world_from_camera[2];
  const RenderedView view = renderer.render(pose);
  int on_ground = 0;
  int looked_at = 0;
  for (int row = 0; row < view.depth.rows; row += 5) {
    for (int col = 0; col < view.depth.cols; col += 5) {
      const Eigen::Vector3d point = point_in_world(renderer, view, pose, col, row);
      ++looked_at;
      // Walls are steep: there a millimetre sideways is more than this upwards.
      if (std::abs(point.z() - height_at(flight.world.surface, point.x(), point.y())) < 0.01) ++on_ground;
    }
  }
  EXPECT_GT(on_ground, 0.95 * looked_at);
}

TEST(Renderer, PointsLookTheSameFromTheNextView) {
  const auto& flight = tiny_flight();
  const Renderer renderer(flight.world, tiny_camera());
  const Pose& here = flight.world_from_camera[3];
  const Pose& there = flight.world_from_camera[4];
  const RenderedView from_here = renderer.render(here);
  const RenderedView from_there = renderer.render(there);
  int alike = 0;
  int seen = 0;
  for (int row = 0; row < from_here.depth.rows; ++row) {
    for (int col = 0; col < from_here.depth.cols; ++col) {
      const Eigen::Vector3d point = point_in_world(renderer, from_here, here, col, row);
      const auto pixel = project(renderer.camera(), there.inverse() * point);
      if (!pixel || pixel->minCoeff() < 0 || pixel->x() > renderer.camera().width - 1 ||
          pixel->y() > renderer.camera().height - 1)
        continue;
      const auto there_col = static_cast<int>(std::lround(pixel->x()));
      const auto there_row = static_cast<int>(std::lround(pixel->y()));
      const double expected_depth = (there.inverse() * point).z();
      ++seen;
      const double colour = cv::norm(from_here.image(row, col) - from_there.image(there_row, there_col), cv::NORM_INF);
      // Half a pixel off (0.13 m here), so the texture need not be the same to the bit.
      if (std::abs(expected_depth - from_there.depth(there_row, there_col)) < 0.3 && colour < 40) ++alike;
    }
  }
  ASSERT_GT(seen, 1000);
  EXPECT_GT(alike, 0.93 * seen);
}

TEST(Renderer, RefusesACameraThatIsNone) { EXPECT_THROW(Renderer(tiny_flight().world, Camera{}), InputError); }

TEST(Photograph, IsTheSameForTheSameFrameOnly) {
  const cv::Mat3b clean(48, 64, cv::Vec3b(90, 120, 100));
  const cv::Mat3b once = photograph(clean, draw_camera_effects(7));
  EXPECT_EQ(cv::norm(once, photograph(clean, draw_camera_effects(7)), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(once, photograph(clean, draw_camera_effects(8)), cv::NORM_INF), 0);
}

TEST(Photograph, NoiseHasTheStatedDeviation) {
  const cv::Mat3b clean(200, 200, cv::Vec3b(128, 128, 128));
  CameraEffects effects;
  effects.vignetting = 0;
  effects.defocus_px = 0;
  effects.noise = 4;
  cv::Scalar mean, deviation;
  cv::meanStdDev(photograph(clean, effects), mean, deviation);
  // 40000 samples tell the deviation to 0.5 %; rounding adds 0.3^2.
  EXPECT_NEAR(mean[1], 128, 0.2);
  EXPECT_NEAR(deviation[1], 4, 0.15);
}

TEST(Photograph, MotionBlursAlongItsWayOnly) {
  cv::Mat3b clean(41, 41, cv::Vec3b(0, 0, 0));
  clean.col(20).setTo(cv::Scalar(200, 200, 200));
  CameraEffects effects;
  effects.noise = 0;
  effects.vignetting = 0;
  effects.defocus_px = 0;
  effects.sharpening = 0;
  effects.motion_px = {0, 6};
  EXPECT_NEAR(photograph(clean, effects)(20, 20)[0], 200, 1);
  effects.motion_px = {6, 0};
  EXPECT_LT(photograph(clean, effects)(20, 20)[0], 60);
}

}  // namespace
}  // namespace fabloop
