// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/geometry/camera.h"

#include <gtest/gtest.h>

#include "frontend/error.h"

namespace fabloop {
namespace {

Camera lens(DistortionModel model, std::vector<double> distortion) {
  return {640, 480, 500, 505, 319.5, 239.5, model, std::move(distortion)};
}

/// Undistortion iterates until 1e-10 of a focal length.
constexpr double kPixelTolerance = 1e-6;

void expect_round_trip(const Camera& camera) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < camera.height; y += 60) {
    for (int x = 0; x < camera.width; x += 80) pixels.emplace_back(x, y);
  }
  const auto rays = bearings(camera, pixels);
  ASSERT_EQ(rays.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto pixel = project(camera, 7.0 * rays[i]);
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT((*pixel - pixels[i]).norm(), kPixelTolerance) << "pixel " << pixels[i].transpose();
  }
}

TEST(Camera, ProjectionInvertsBearingsWithoutALens) { expect_round_trip(lens(DistortionModel::Radtan, {})); }

TEST(Camera, ProjectionInvertsBearingsForPlumbBob) {
  expect_round_trip(lens(DistortionModel::Radtan, {-0.1, 0.03, 0.001, -0.002, 0.005}));
}

TEST(Camera, ProjectionInvertsBearingsForEquidistant) {
  expect_round_trip(lens(DistortionModel::Equidistant, {-0.02, 0.004, -0.003, 0.001}));
}

TEST(Camera, PointsBehindHaveNoPixel) { EXPECT_FALSE(project(lens(DistortionModel::Radtan, {}), {0, 0, -1}).has_value()); }

TEST(Camera, ScalingKeepsTheCornersOfTheImage) {
  const Camera half = scaled(lens(DistortionModel::Radtan, {}), 0.5);
  EXPECT_EQ(half.width, 320);
  EXPECT_DOUBLE_EQ(half.cx, 159.5);  // the centre of 640 pixels is 319.5, that of 320 is 159.5
}

TEST(Camera, ValidationNamesThePlaceAndTheFault) {
  Camera camera = lens(DistortionModel::Radtan, {0.1});
  try {
    validate(camera, "camera.yaml");
    FAIL() << "one coefficient was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("camera.yaml"), std::string::npos);
  }
  camera.distortion.clear();
  EXPECT_NO_THROW(validate(camera, "camera.yaml"));
  camera.fx = 0;
  EXPECT_THROW(validate(camera, "camera.yaml"), InputError);
}

}  // namespace
}  // namespace fabloop
