// SPDX-License-Identifier: BSD-3-Clause
#include "data/meadow.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "data/meadow_layout.h"
#include "data/meadow_surface.h"
#include "data/noise.h"
#include "frontend/error.h"
#include "frontend/geometry/pose.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Rows that one task makes.
constexpr int kBandRows = 64;

/// Light from the sky alone, in shadow; and the sun's share on a surface that faces it.
constexpr float kSkyLight = 0.46F;
constexpr float kSunLight = 0.80F;

/// Calls `body(row)` for every row in parallel, and tells how far it is.
void for_each_row(int rows, const char* stage, const MeadowOptions& options, const std::function<void(int)>& body) {
  const int bands = (rows + kBandRows - 1) / kBandRows;
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(static_cast<std::size_t>(bands), options.num_threads, [&](std::size_t band) {
    const int first = static_cast<int>(band) * kBandRows;
    for (int row = first; row < std::min(rows, first + kBandRows); ++row) body(row);
    const std::scoped_lock lock(mutex);
    ++done;
    if (options.progress) options.progress(stage, done, static_cast<std::size_t>(bands));
  });
}

HeightMap empty_map(const GroundArea& area, double spacing_m) {
  HeightMap map;
  map.origin = area.min;
  map.spacing_m = spacing_m;
  const Eigen::Vector2d cells = (area.max - area.min) / spacing_m;
  map.heights.create(static_cast<int>(std::ceil(cells.y())) + 1, static_cast<int>(std::ceil(cells.x())) + 1);
  return map;
}

enum class Objects { None, Standing };

HeightMap make_heights(const MeadowLayout& layout, double spacing_m, Objects objects, const MeadowOptions& options) {
  HeightMap map = empty_map(layout.area, spacing_m);
  for_each_row(map.heights.rows, "heights", options, [&](int row) {
    for (int col = 0; col < map.heights.cols; ++col) {
      const auto x = static_cast<float>(map.origin.x() + col * spacing_m);
      const auto y = static_cast<float>(map.origin.y() + row * spacing_m);
      map.heights(row, col) =
          terrain_height(layout, x, y) + (objects == Objects::Standing ? cover_at(layout, x, y).height_m : 0.0F);
    }
  });
  update_block_max(map);
  return map;
}

Eigen::Vector3d direction_to_sun(const MeadowOptions& options) {
  const double elevation = rad_from_deg(options.sun_elevation_deg);
  const double azimuth = rad_from_deg(options.sun_azimuth_deg);
  return {std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth), std::sin(elevation)};
}

/// 1 where the sun is seen, 0 in shadow.
float sunlit(const HeightMap& map, int row, int col, const Eigen::Vector3d& to_sun) {
  const double step_m = 1.5 * map.spacing_m;
  double x = map.origin.x() + col * map.spacing_m;
  double y = map.origin.y() + row * map.spacing_m;
  double z = map.heights(row, col) + 0.05;
  const double sideways = std::hypot(to_sun.x(), to_sun.y());
  while (z < map.max_height) {
    x += step_m * to_sun.x() / sideways;
    y += step_m * to_sun.y() / sideways;
    z += step_m * to_sun.z() / sideways;
    const int c = static_cast<int>(std::lround((x - map.origin.x()) / map.spacing_m));
    const int r = static_cast<int>(std::lround((y - map.origin.y()) / map.spacing_m));
    if (c < 0 || r < 0 || c >= map.heights.cols || r >= map.heights.rows) return 1;
    // A whole block that lies below the ray cannot shade it, and skipping it is most of the speed.
    if (map.block_max(r / HeightMap::kBlock, c / HeightMap::kBlock) < z) continue;
    if (map.heights(r, c) > z) return 0;
  }
  return 1;
}

/// Light on each sample of the surface: sky and sun on its slope, and shadows with soft edges.
cv::Mat1f make_light(const HeightMap& surface, const MeadowOptions& options) {
  const Eigen::Vector3d to_sun = direction_to_sun(options);
  const cv::Mat1f& heights = surface.heights;
  cv::Mat1f shadow(heights.size());
  cv::Mat1f light(heights.size());
  for_each_row(heights.rows, "shadows", options, [&](int row) {
    for (int col = 0; col < heights.cols; ++col) shadow(row, col) = sunlit(surface, row, col, to_sun);
  });
  cv::GaussianBlur(shadow, shadow, {}, 0.12 / surface.spacing_m, 0, cv::BORDER_REPLICATE);
  for_each_row(heights.rows, "light", options, [&](int row) {
    const int below = std::max(0, row - 1);
    const int above = std::min(heights.rows - 1, row + 1);
    for (int col = 0; col < heights.cols; ++col) {
      const int left = std::max(0, col - 1);
      const int right = std::min(heights.cols - 1, col + 1);
      const double dx = (heights(row, right) - heights(row, left)) / (2 * surface.spacing_m);
      const double dy = (heights(above, col) - heights(below, col)) / (2 * surface.spacing_m);
      const double facing = std::max(0.0, Eigen::Vector3d(-dx, -dy, 1).normalized().dot(to_sun)) / to_sun.z();
      light(row, col) = kSkyLight + kSunLight * shadow(row, col) * static_cast<float>(std::min(1.5, facing));
    }
  });
  return light;
}

cv::Mat3b make_texture(const MeadowLayout& layout, const HeightMap& surface, const cv::Mat1f& light,
                       const MeadowOptions& options) {
  const Eigen::Vector2d pixels = (layout.area.max - layout.area.min) / options.texture_m_per_px;
  cv::Mat3b texture(static_cast<int>(std::ceil(pixels.y())), static_cast<int>(std::ceil(pixels.x())));
  const HeightMap light_map{surface.origin, surface.spacing_m, light, {}, 0};
  for_each_row(texture.rows, "texture", options, [&](int row) {
    for (int col = 0; col < texture.cols; ++col) {
      const auto x = static_cast<float>(layout.area.min.x() + col * options.texture_m_per_px);
      const auto y = static_cast<float>(layout.area.min.y() + row * options.texture_m_per_px);
      const Cover cover = cover_at(layout, x, y);
      const Colour colour = cover.object != nullptr ? object_colour(layout, cover, x, y) : ground_colour(layout, x, y);
      const Colour lit = colour * static_cast<float>(height_at(light_map, x, y));
      texture(row, col) = {cv::saturate_cast<uchar>(lit.x()), cv::saturate_cast<uchar>(lit.y()),
                           cv::saturate_cast<uchar>(lit.z())};
    }
  });
  return texture;
}

void check(const GroundArea& area, const MeadowOptions& options) {
  const auto fail = [](const std::string& what) { throw InputError("meadow: " + what); };
  const Eigen::Vector2d size = area.max - area.min;
  if (!(size.minCoeff() >= 10)) fail("the area must be at least 10 m wide and high");
  if (!(options.texture_m_per_px >= 0.005) || !(options.height_m_per_px >= 0.005)) fail("a pixel must be at least 0.005 m");
  constexpr double kMaxPixels = 4e8;
  const double finest = std::min(options.texture_m_per_px, options.height_m_per_px);
  if (size.prod() / (finest * finest) > kMaxPixels) {
    fail("the area is too large (more than 400 million pixels of texture); ask for a shorter flight or a coarser texture");
  }
  if (!(options.sun_elevation_deg >= 10 && options.sun_elevation_deg < 90))
    fail("the sun's elevation must be in [10, 90) degrees");
}

}  // namespace

World make_meadow(const GroundArea& area, const MeadowOptions& options) {
  check(area, options);
  const MeadowLayout layout = plan_meadow(area, options.seed);
  World world;
  world.area = area;
  constexpr double kTerrainSpacingM = 1.0;
  world.terrain = make_heights(layout, kTerrainSpacingM, Objects::None, options);
  world.surface = make_heights(layout, options.height_m_per_px, Objects::Standing, options);
  const cv::Mat1f light = make_light(world.surface, options);
  world.texture_m_per_px = options.texture_m_per_px;
  world.texture.push_back(make_texture(layout, world.surface, light, options));
  update_texture_levels(world);
  return world;
}

}  // namespace fabloop
