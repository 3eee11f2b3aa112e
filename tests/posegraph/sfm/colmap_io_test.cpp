// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/colmap_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "frontend/error.h"
#include "posegraph/sfm/colmap_camera.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using test::ScratchFolder;
using testing::HasSubstr;

// Half a pixel is added and taken away again: one rounding of a number of a few thousand.
constexpr double kHalfPixelRounding = 1e-12 * 4096;

Reconstruction random_reconstruction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Reconstruction result;
  result.cameras = {{640, 480, 500.1, 501.2, 319.3, 239.4, DistortionModel::Radtan, {0.1, -0.02, 1e-3, -2e-3, 0.03}},
                    {1200, 900, 900.5, 900.5, 599.5, 449.5, DistortionModel::Equidistant, {0.01, 0.02, -0.03, 0.004}},
                    {800, 600, 700, 710, 400, 300, DistortionModel::Radtan, {}}};
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    result.images.push_back({i,
                             "/flight/strip" + std::to_string(i % 2) + "/a" + std::to_string(i) + ".jpg",
                             0,
                             i % 3,
                             {q.normalized(), {normal(random), normal(random), normal(random)}}});
  }
  for (int p = 0; p < 40; ++p) {
    ScenePoint point;
    point.x_in_world = {normal(random), normal(random), normal(random)};
    point.red_green_blue = {static_cast<unsigned char>(p), static_cast<unsigned char>(2 * p), 255};
    for (std::size_t i = 0; i < 6; ++i) {
      if (random() % 2 == 0) point.track.push_back({i, {640 * std::abs(normal(random)), 100 * std::abs(normal(random))}});
    }
    result.points.push_back(point);
  }
  return result;
}

TEST(ColmapIo, WhatIsWrittenReadsBack) {
  const ScratchFolder folder;
  std::mt19937 random(1);
  const Reconstruction written = random_reconstruction(random);
  write_colmap_model(folder.path(), written);
  const Reconstruction read = read_colmap_model(folder.path());
  ASSERT_EQ(read.images.size(), written.images.size());
  ASSERT_EQ(read.points.size(), written.points.size());
  for (std::size_t i = 0; i < read.images.size(); ++i) {
    EXPECT_EQ(read.images[i].camera, written.images[i].camera);
    EXPECT_EQ(read.images[i].image_path, written.images[i].image_path.lexically_relative("/flight"));
    // Two inversions of a pose.
    EXPECT_LT(
        rotation_angle(read.images[i].world_from_camera.rotation.conjugate() * written.images[i].world_from_camera.rotation),
        1e-14);
    EXPECT_LT((read.images[i].world_from_camera.translation - written.images[i].world_from_camera.translation).norm(), 1e-14);
  }
  for (std::size_t p = 0; p < read.points.size(); ++p) {
    EXPECT_EQ(read.points[p].x_in_world, written.points[p].x_in_world);
    EXPECT_EQ(read.points[p].red_green_blue, written.points[p].red_green_blue);
    ASSERT_EQ(read.points[p].track.size(), written.points[p].track.size());
    for (std::size_t k = 0; k < read.points[p].track.size(); ++k) {
      EXPECT_EQ(read.points[p].track[k].image, written.points[p].track[k].image);
      EXPECT_LT((read.points[p].track[k].pixel - written.points[p].track[k].pixel).norm(), kHalfPixelRounding);
    }
  }
}

TEST(ColmapIo, EveryLensShowsTheSamePixelHalfAPixelApart) {
  // Camera, then the same lens in COLMAP's terms by its documentation: the model's own formula.
  const Eigen::Vector3d x(0.3, -0.2, 1);
  const double r2 = x.head<2>().squaredNorm();
  const auto simple = camera_from_colmap("SIMPLE_RADIAL", 640, 480, {500, 320, 240, 0.1});
  ASSERT_TRUE(simple);
  EXPECT_NEAR(project(*simple, x)->x() + 0.5, 500 * 0.3 * (1 + 0.1 * r2) + 320, 1e-9);
  const auto radial = camera_from_colmap("RADIAL", 640, 480, {500, 320, 240, 0.1, -0.03});
  ASSERT_TRUE(radial);
  EXPECT_NEAR(project(*radial, x)->y() + 0.5, 500 * -0.2 * (1 + 0.1 * r2 - 0.03 * r2 * r2) + 240, 1e-9);
  const auto pinhole = camera_from_colmap("PINHOLE", 640, 480, {500, 510, 320, 240});
  ASSERT_TRUE(pinhole);
  EXPECT_NEAR(project(*pinhole, x)->y() + 0.5, 510 * -0.2 + 240, 1e-9);
  const auto fisheye = camera_from_colmap("RADIAL_FISHEYE", 640, 480, {500, 320, 240, 0.1, 0.05});
  ASSERT_TRUE(fisheye);
  const double r = std::sqrt(r2);
  const double theta = std::atan(r);
  const double bent = theta * (1 + 0.1 * theta * theta + 0.05 * std::pow(theta, 4));
  EXPECT_NEAR(project(*fisheye, x)->x() + 0.5, 500 * 0.3 / r * bent + 320, 1e-9);
  const auto full = camera_from_colmap("FULL_OPENCV", 640, 480, {500, 510, 320, 240, .1, .2, .01, .02, .3, .04, .05, .06});
  ASSERT_TRUE(full);
  const double ratio = (1 + .1 * r2 + .2 * r2 * r2 + .3 * r2 * r2 * r2) / (1 + .04 * r2 + .05 * r2 * r2 + .06 * r2 * r2 * r2);
  EXPECT_NEAR(project(*full, x)->x() + 0.5, 500 * (0.3 * ratio + 2 * .01 * 0.3 * -0.2 + .02 * (r2 + 2 * 0.09)) + 320, 1e-9);
  EXPECT_FALSE(camera_from_colmap("FOV", 640, 480, {500, 510, 320, 240, 0.9}));
}

TEST(ColmapIo, ColmapsOwnLinesAreRead) {
  const ScratchFolder folder;
  folder.write("cameras.txt", "# a comment\n7 SIMPLE_PINHOLE 100 80 90 50 40\n");
  // A camera at (0, 0, 10) that looks down the world's z axis: camera_from_world is a half turn about x.
  folder.write("images.txt",
               "# two lines an image\n4 0 1 0 0 0 0 10 7 b.jpg\n50.5 40.5 -1 30 20 12\n2 1 0 0 0 0 0 0 7 a.jpg\n\n");
  folder.write("points3D.txt", "12 1 2 3 10 20 30 0.5 4 1\n");
  const Reconstruction read = read_colmap_model(folder.path());
  ASSERT_EQ(read.images.size(), 2U);
  EXPECT_EQ(read.images[0].image_path, "a.jpg");
  EXPECT_TRUE(read.images[1].world_from_camera.translation.isApprox(Eigen::Vector3d(0, 0, 10)));
  ASSERT_EQ(read.points.size(), 1U);
  ASSERT_EQ(read.points[0].track.size(), 1U);
  EXPECT_EQ(read.points[0].track[0].image, 1U);
  EXPECT_EQ(read.points[0].track[0].pixel, Eigen::Vector2d(29.5, 19.5));
}

TEST(ColmapIo, BadLinesAreNamed) {
  const ScratchFolder folder;
  folder.write("cameras.txt", "1 FOV 100 80 90 90 50 40 0.9\n");
  EXPECT_THAT(test::message_of<InputError>([&] { read_colmap_model(folder.path()); }), HasSubstr("cameras.txt:1"));
  folder.write("cameras.txt", "1 SIMPLE_PINHOLE 100 80 90 50 40\n");
  folder.write("images.txt", "1 1 0 0 0 0 0 0 3 a.jpg\n\n");
  EXPECT_THAT(test::message_of<InputError>([&] { read_colmap_model(folder.path()); }), HasSubstr("camera 3"));
  folder.write("images.txt", "1 1 0 0 0 0 0 0 1 a.jpg\n\n");
  folder.write("points3D.txt", "12 1 2 3 10 20 30 0.5 1 0\n");
  EXPECT_THAT(test::message_of<InputError>([&] { read_colmap_model(folder.path()); }), HasSubstr("points3D.txt:1"));
}

}  // namespace
}  // namespace fabloop
