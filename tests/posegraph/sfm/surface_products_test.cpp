// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/surface_products.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <GeographicLib/UTMUPS.hpp>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "frontend/error.h"
#include "posegraph/sfm/colmap_io.h"
#include "posegraph/sfm/geo_exchange.h"
#include "posegraph/sfm/geodesy.h"
#include "posegraph/sfm/raster_output.h"
#include "posegraph/sfm/run_reader.h"
#include "posegraph/sfm/surface_mesh.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/sfm/bump_world.h"

namespace fabloop {
namespace {

using test::BumpWorld;
using test::ScratchFolder;
using testing::HasSubstr;
using testing::StartsWith;

const GeoPosition kBrisbane{-27.4773, 153.0271, 30};  // the southern hemisphere, east of its zone's meridian

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The doubles of a TIFF tag, found by its id in the first directory of a little-endian file.
std::vector<double> tiff_doubles(const std::string& file, std::uint16_t tag) {
  const auto number = [&]<typename Number>(std::size_t at, Number) {
    Number value{};
    std::memcpy(&value, &file[at], sizeof(value));
    return value;
  };
  const auto directory = number(4, std::uint32_t{});
  const auto count = number(directory, std::uint16_t{});
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    if (number(entry, std::uint16_t{}) != tag) continue;
    std::vector<double> values(number(entry + 4, std::uint32_t{}));
    std::memcpy(values.data(), &file[number(entry + 8, std::uint32_t{})], values.size() * sizeof(double));
    return values;
  }
  return {};
}

TEST(Geodesy, TheMapGridAgreesWithTheExactProjectionNearby) {
  const MapGrid grid = map_grid_at(kBrisbane);
  EXPECT_EQ(grid.epsg, 32756);
  const Eigen::Vector3d x(400, -300, 0);
  const GeoPosition place = geo_from_local(kBrisbane, x);
  EXPECT_LT((local_from_geo(kBrisbane, place) - x).norm(), 1e-6);
  int zone = 0;
  bool is_north = false;
  double easting = 0, northing = 0;
  GeographicLib::UTMUPS::Forward(place.latitude_deg, place.longitude_deg, zone, is_north, easting, northing);
  const Eigen::Vector2d turned = Eigen::Rotation2Dd(rad_from_deg(grid.convergence_deg)) * x.head<2>();
  // Half a kilometre away: centimetres, as documented.
  EXPECT_NEAR(grid.easting_m + grid.scale * turned.x(), easting, 0.01);
  EXPECT_NEAR(grid.northing_m + grid.scale * turned.y(), northing, 0.01);
  EXPECT_THROW(map_grid_at({153, -27, 0}), InputError);
}

TEST(RasterOutput, GeoTiffCornersAreTheOuterEdgesOfTheirPixels) {
  const ScratchFolder folder;
  const GroundGrid grid = grid_over({0, 0}, {30, 20}, 0.5);
  MapGrid map;
  map.epsg = 32756;
  map.easting_m = 500000;
  map.northing_m = 7000000;
  map.scale = 0.9996;
  const cv::Mat1f heights(grid.rows, grid.columns, 1.0F);
  write_tiff(folder.path() / "a.tif", grid, heights, cv::Mat1b(heights.size(), 255), map);
  const std::string file = text_of(folder.path() / "a.tif");
  const std::vector<double> tie_point = tiff_doubles(file, 33922);
  const std::vector<double> scale = tiff_doubles(file, 33550);
  ASSERT_EQ(tie_point.size(), 6U);
  ASSERT_EQ(scale.size(), 3U);
  EXPECT_EQ(tie_point[0], 0);
  EXPECT_DOUBLE_EQ(tie_point[3], 500000);  // x = 0 is the western edge
  EXPECT_DOUBLE_EQ(tie_point[4], 7000000 + 20 * 0.9996);
  EXPECT_DOUBLE_EQ(scale[0], 0.5 * 0.9996);
  write_world_file(folder.path() / "a.tfw", grid);
  EXPECT_EQ(text_of(folder.path() / "a.tfw"), "0.5\n0\n0\n-0.5\n0.25\n19.75\n");
}

TEST(SurfaceMesh, FacesUpAndCarriesItsTexture) {
  HeightField field{grid_over({0, 0}, {4, 3}, 1), cv::Mat1f(3, 4, 2.0F), cv::Mat1f(3, 4, 1.0F)};
  const cv::Mat3b colour(3, 4, cv::Vec3b(1, 2, 3));
  cv::Mat1b shown(3, 4, static_cast<unsigned char>(255));
  shown(0, 0) = 0;
  const SurfaceMesh mesh = mesh_of(field, {field.grid, colour, shown}, {}, 1000);
  EXPECT_EQ(mesh.vertices.size(), 11U);
  EXPECT_EQ(mesh.triangles.size(), 11U);  // 12 of 6 squares, less the one at the missing corner
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].x_in_world;
    EXPECT_GT((mesh.vertices[t[1]].x_in_world - a).cross(mesh.vertices[t[2]].x_in_world - a).z(), 0);
  }
  EXPECT_EQ(mesh.vertices[0].x_in_world, Eigen::Vector3d(1.5, 2.5, 2));
  EXPECT_EQ(mesh.vertices[0].red_green_blue, cv::Vec3b(3, 2, 1));
  EXPECT_TRUE(mesh.texture_at[0].isApprox(Eigen::Vector2d(1.5 / 4, 1 - 0.5 / 3)));
}

TEST(GroundView, UpIsTheMeanPlanesSideOfTheCameras) {
  const ScratchFolder folder;
  BumpWorld world;
  world.hill_height = 0;
  Reconstruction reconstruction = world.reconstruction(folder.path());
  const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, 0.5).normalized())), {3, 4, 5}};
  for (ScenePoint& point : reconstruction.points) point.x_in_world = turned * point.x_in_world;
  for (PlacedImage& image : reconstruction.images) image.world_from_camera = turned * image.world_from_camera;
  reconstruction.points.front().x_in_world += Eigen::Vector3d(0, 0, 500);  // one wild point
  const Pose upright = ground_from_world(reconstruction);
  const Eigen::Vector3d up = upright.rotation * (turned.rotation * Eigen::Vector3d::UnitZ());
  EXPECT_LT((up - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(SurfaceProducts, AreAllThereAndReadBack) {
  const ScratchFolder folder;
  const BumpWorld world;
  Reconstruction reconstruction = world.reconstruction(folder.path());
  SurfaceProductsOptions options;
  options.loops = {{8, 0}};
  options.num_threads = 1;
  const SurfaceReport local = write_surface_products(reconstruction, folder.path() / "local", options);
  EXPECT_FALSE(local.epsg);
  for (const char* name : {"orthomosaic.png", "orthomosaic.pgw", "surface.tif", "surface.tfw", "mesh.obj", "mesh.mtl",
                           "texture.jpg", "mesh.ply", "points.ply", "map_figure.png", "colmap/images.txt", "surface.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "local" / name)) << name;
  }
  EXPECT_EQ(local.num_image_reads, reconstruction.images.size());
  const Reconstruction again = read_colmap_model(folder.path() / "local/colmap", folder.path());
  EXPECT_EQ(again.images.back().image_path, reconstruction.images.back().image_path);
  double sum = 0;
  int count = 0;
  for (const ScenePoint& point : read_points_ply(folder.path() / "local/points.ply")) {
    const Eigen::Vector3d& x = point.x_in_world;
    if (std::abs(x.x()) > 8 || std::abs(x.y()) > 6) continue;  // where at least three pictures show it
    sum += std::pow(x.z() - world.height_at(x.x(), x.y()), 2);
    ++count;
  }
  ASSERT_GT(count, 100);
  // A step of the sweep is 0.4 m. The mean plane may tilt, but points are in the world's frame.
  EXPECT_LT(std::sqrt(sum / count), 0.3);
  EXPECT_THROW(write_surface_products(reconstruction, folder.path() / "local", options), InputError);
  reconstruction.origin = kBrisbane;
  options.detail = SurfaceDetail::Points;
  const SurfaceReport global = write_surface_products(reconstruction, folder.path() / "global", options);
  EXPECT_EQ(global.epsg, 32756);
  EXPECT_THAT(text_of(folder.path() / "global/geo.txt"), StartsWith("EPSG:4326\nimage0.png 153.02"));
  EXPECT_THAT(text_of(folder.path() / "global/track.kml"), HasSubstr("loop 8 - 0"));
  const auto json = nlohmann::json::parse(text_of(folder.path() / "global/track.geojson"));
  EXPECT_EQ(json["features"].size(), 2U);
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"].size(), reconstruction.images.size());
  EXPECT_NEAR(json["features"][1]["geometry"]["coordinates"][0][1].get<double>(), kBrisbane.latitude_deg, 1e-3);
}

TEST(SurfaceProducts, WhatCannotBeIsSaid) {
  const ScratchFolder folder;
  const BumpWorld world;
  Reconstruction reconstruction = world.reconstruction(folder.path());
  reconstruction.points.resize(4);
  EXPECT_THAT(test::message_of<InputError>([&] { write_surface_products(reconstruction, folder.path() / "out"); }),
              HasSubstr("points"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  EXPECT_THROW(write_surface_products({}, folder.path() / "out"), InputError);
}

}  // namespace
}  // namespace fabloop
