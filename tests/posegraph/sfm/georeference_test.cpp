// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/georeference.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "frontend/error.h"
#include "posegraph/sfm/geodesy.h"
#include "posegraph/sfm/gps.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

Segment flight(std::size_t count, double width) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  Segment segment;
  for (std::size_t i = 0; i < count; ++i) {
    segment.world_from_cameras.push_back(
        Pose{Eigen::Quaterniond::Identity(), {10 * unit(random), width * unit(random), 0.3 * width * unit(random)}});
  }
  return segment;
}

TEST(Georeference, FindsTheSimilarityThroughWildPositions) {
  const Segment segment = flight(40, 5.0);
  const Pose known_from_world{rotation_from_vector({1.0, -0.5, 2.0}), {100, -50, 30}};
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.5);
  std::vector<std::optional<Eigen::Vector3d>> known;
  for (std::size_t i = 0; i < 40; ++i) {
    const Eigen::Vector3d x =
        12.0 * (known_from_world.rotation * segment.world_from_cameras[i]->translation) + known_from_world.translation;
    known.push_back(x + Eigen::Vector3d(noise(random), noise(random), noise(random)));
    if (i % 5 == 0) *known.back() += Eigen::Vector3d(80, 0, -60);
    if (i % 7 == 3) known.back().reset();
  }
  const GeoreferenceResult result = georeference(segment, known, {.sigma_m = 0.5});
  ASSERT_TRUE(result.found) << result.why_not;
  EXPECT_NEAR(result.found->scale, 12.0, 0.1);
  EXPECT_LT(rotation_angle(result.found->known_from_world.rotation.conjugate() * known_from_world.rotation), 0.02);
  EXPECT_LT((result.found->known_from_world.translation - known_from_world.translation).norm(), 0.6);
  // Noise of 0.5 along each of three axes.
  EXPECT_NEAR(result.found->rms_m, 0.87, 0.25);
}

TEST(Georeference, SaysWhyThereIsNone) {
  const Segment line = flight(20, 0.0);
  std::vector<std::optional<Eigen::Vector3d>> known;
  for (const auto& pose : line.world_from_cameras) known.push_back(pose->translation);
  EXPECT_NE(georeference(line, known).why_not.find("one line"), std::string::npos);
  const Segment wide = flight(20, 5.0);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> anywhere(-1000, 1000);
  for (auto& position : known) position = Eigen::Vector3d(anywhere(random), anywhere(random), anywhere(random));
  EXPECT_FALSE(georeference(wide, known).found);
  known.assign(20, std::nullopt);
  EXPECT_NE(georeference(wide, known).why_not.find("only 0"), std::string::npos);
}

TEST(Georeference, MovesASegmentAsASimilarity) {
  Segment segment = flight(3, 5.0);
  segment.points.push_back(SegmentPoint{{1, 2, 3}, {0, 1}});
  const Eigen::Vector3d before = segment.world_from_cameras[1]->inverse() * segment.points[0]->x_in_world;
  move_segment(segment, 4.0, {rotation_from_vector({0.3, 0.2, -0.9}), {5, 6, 7}});
  const Eigen::Vector3d after = segment.world_from_cameras[1]->inverse() * segment.points[0]->x_in_world;
  EXPECT_LT((after - 4.0 * before).norm(), 1e-12);
}

TEST(EastNorthUp, AgreesWithTheEllipsoidsRadii) {
  // At 45 degrees north: 1e-4 degrees are 11.1132 m north (meridian radius 6367381.8 m) and 7.8847 m east (normal radius
  // 6388838.3 m).
  const GeoPosition origin{45.0, 7.0, 300.0};
  const Eigen::Vector3d north = local_from_geo(origin, {45.0001, 7.0, 300.0});
  EXPECT_NEAR(north.y(), (6367381.8156 + 300) * rad_from_deg(1e-4), 1e-4);
  EXPECT_NEAR(north.x(), 0, 1e-9);
  const Eigen::Vector3d east = local_from_geo(origin, {45.0, 7.0001, 300.0});
  EXPECT_NEAR(east.x(), (6388838.2901 + 300) * std::cos(rad_from_deg(45.0)) * rad_from_deg(1e-4), 1e-4);
  EXPECT_NEAR(local_from_geo(origin, {45.0, 7.0, 312.5}).z(), 12.5, 1e-8);
}

TEST(ReadGps, GivesEachImageItsPositionAndNamesBadLines) {
  const test::ScratchFolder folder;
  Sequence sequence;
  sequence.name = "flight";
  for (const char* name : {"a.jpg", "b.jpg"})
    sequence.frames.push_back({.image_path = name, .odom_from_camera = {}, .world_from_camera = {}});
  const auto path = folder.path() / "gps.csv";
  const auto write = [&](const char* text) { std::ofstream(path) << text; };
  write("# filename,latitude_deg,longitude_deg,altitude_m\nb.jpg,45.5,-7.25,12.5\r\n");
  const auto positions = read_gps(path, sequence);
  EXPECT_FALSE(positions[0]);
  EXPECT_DOUBLE_EQ(positions[1]->latitude_deg, 45.5);
  EXPECT_DOUBLE_EQ(positions[1]->longitude_deg, -7.25);
  EXPECT_DOUBLE_EQ(positions[1]->altitude_m, 12.5);
  for (const char* bad : {"a.jpg,45,7\n", "a.jpg,north,7,1\n", "a.jpg,95,7,1\n", "a.jpg,45,7,1,9\n"}) {
    write(bad);
    try {
      read_gps(path, sequence);
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("gps.csv:1"), std::string::npos);
    }
  }
  write("c.jpg,45,7,1\n");
  EXPECT_THROW(read_gps(path, sequence), InputError);
}

TEST(LocalPositions, AreAboutTheMiddleWhateverTheFirstOneSays) {
  // Receivers without a fix write zeros.
  std::vector<std::optional<GeoPosition>> positions{GeoPosition{0, 0, 0}, std::nullopt};
  for (int i = 0; i < 9; ++i) positions.push_back(GeoPosition{46.8425 + 1e-4 * i, -91.9939 + 1e-4 * i, 198.0 + i});
  const LocalPositions local = local_positions(positions);
  EXPECT_DOUBLE_EQ(local.origin.latitude_deg, 46.8429);
  EXPECT_DOUBLE_EQ(local.origin.altitude_m, 202.0);
  EXPECT_FALSE(local.east_north_up_m[1]);
  for (std::size_t i = 2; i < positions.size(); ++i) EXPECT_LT(local.east_north_up_m[i]->norm(), 70.0);
}

TEST(LocalPositions, OfNoneAreNone) {
  const LocalPositions local = local_positions({std::nullopt, std::nullopt});
  EXPECT_EQ(local.east_north_up_m.size(), 2U);
  EXPECT_FALSE(local.east_north_up_m[0] || local.east_north_up_m[1]);
}

}  // namespace
}  // namespace fabloop
