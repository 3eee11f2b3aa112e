// SPDX-License-Identifier: BSD-3-Clause
#include "data/meadow_surface.h"

#include <algorithm>
#include <cmath>

#include "data/noise.h"
#include "frontend/geometry/pose.h"

namespace fabloop {
namespace {

Colour rgb(float red, float green, float blue) { return {blue, green, red}; }

Colour blend(const Colour& a, const Colour& b, float t) { return a + (b - a) * t; }

/// Half sizes of the shed, and where its roof begins and ends.
constexpr float kShedHalfLengthM = 3.6F;
constexpr float kShedHalfWidthM = 2.4F;
constexpr float kEavesFraction = 0.62F;

/// Along the ridge and across it.
Eigen::Vector2f in_shed(const MeadowObject& shed, float x, float y) {
  const float dx = x - static_cast<float>(shed.centre.x());
  const float dy = y - static_cast<float>(shed.centre.y());
  const auto cos = static_cast<float>(std::cos(shed.heading_rad));
  const auto sin = static_cast<float>(std::sin(shed.heading_rad));
  return {dx * cos + dy * sin, -dx * sin + dy * cos};
}

float shed_height(const MeadowObject& shed, float x, float y) {
  const Eigen::Vector2f local = in_shed(shed, x, y).cwiseAbs();
  if (local.x() > kShedHalfLengthM || local.y() > kShedHalfWidthM) return 0;
  const float to_ridge = 1.0F - local.y() / kShedHalfWidthM;
  return static_cast<float>(shed.height_m) * (kEavesFraction + (1.0F - kEavesFraction) * to_ridge);
}

float canopy_height(const MeadowObject& plant, float x, float y, std::uint32_t seed) {
  const float dx = x - static_cast<float>(plant.centre.x());
  const float dy = y - static_cast<float>(plant.centre.y());
  const auto radius_m = static_cast<float>(plant.radius_m);
  const float ragged = std::hypot(dx, dy) / radius_m + 0.12F + 0.22F * fractal_noise(x / 0.9F, y / 0.9F, 2, seed + 21);
  if (ragged >= 1.0F) return 0;
  const float clumps = 0.85F + 0.2F * value_noise(x / 0.45F, y / 0.45F, seed + 22);
  return static_cast<float>(plant.height_m) * (1.0F - std::max(0.0F, ragged * ragged)) * clumps;
}

float bale_height(const MeadowObject& bale, float x, float y) {
  const float r = std::hypot(x - static_cast<float>(bale.centre.x()), y - static_cast<float>(bale.centre.y()));
  return r < 0.68F ? static_cast<float>(bale.height_m) : 0.0F;
}

float object_height(const MeadowObject& object, float x, float y, std::uint32_t seed) {
  switch (object.kind) {
    case MeadowObject::Kind::Tree:
    case MeadowObject::Kind::Bush:
      return canopy_height(object, x, y, seed);
    case MeadowObject::Kind::Bale:
      return bale_height(object, x, y);
    case MeadowObject::Kind::Shed:
      return shed_height(object, x, y);
  }
  return 0;
}

/// Brightness of grass: clumps, tussocks, blades. The spectrum is nearly flat below half a metre, as it is in a sward.
float grass_grain(float x, float y, float roughness, std::uint32_t seed) {
  const float clumps = fractal_noise(x / 2.3F, y / 2.3F, 2, seed + 31);
  const float tussocks = value_noise(x / 0.47F + 0.3F * y, y / 0.47F - 0.3F * x, seed + 32);
  const float tufts = value_noise(x / 0.23F - 0.9F * y, y / 0.23F + 0.9F * x, seed + 33);
  const float blades = value_noise(x / 0.11F, y / 0.11F, seed + 34);
  const float dark = smooth_step(0.45F, 0.8F, tussocks + 0.3F * tufts);
  return 1.0F + 0.14F * clumps + (0.85F + 0.15F * roughness) * (0.10F * tussocks + 0.155F * tufts + 0.145F * blades) -
         0.2F * roughness * dark;
}

Colour pasture(float x, float y, float dryness, std::uint32_t seed) {
  const Colour lush = rgb(92, 112, 60);
  const Colour dry = rgb(142, 138, 92);
  return blend(lush, dry, dryness) * grass_grain(x, y, 1.0F, seed);
}

/// Position across the rows of a parcel, in rows.
float across_rows(const MeadowLayout& layout, int parcel, float x, float y, float row_m) {
  const double heading = layout.row_heading_rad[static_cast<std::size_t>(parcel)];
  const float across = -x * static_cast<float>(std::sin(heading)) + y * static_cast<float>(std::cos(heading));
  return (across + 0.35F * value_noise(x / 11.0F, y / 11.0F, layout.seed + 41)) / row_m;
}

Colour mown(const MeadowLayout& layout, int parcel, float x, float y, float dryness) {
  const float phase = across_rows(layout, parcel, x, y, 5.2F);
  const float stripe = std::sin(2.0F * static_cast<float>(kPi) * phase);
  const Colour base = blend(rgb(104, 124, 66), rgb(140, 144, 88), 0.7F * dryness);
  return base * (grass_grain(x, y, 0.25F, layout.seed) + 0.045F * std::clamp(4.0F * stripe, -1.0F, 1.0F));
}

Colour hay(const MeadowLayout& layout, int parcel, float x, float y, float dryness) {
  const float phase = across_rows(layout, parcel, x, y, 3.1F);
  const float ridge = 0.5F + 0.5F * std::cos(2.0F * static_cast<float>(kPi) * phase);
  const float straw = smooth_step(0.45F, 0.95F, ridge + 0.5F * fractal_noise(x / 0.7F, y / 0.7F, 2, layout.seed + 42));
  const Colour stubble = blend(rgb(128, 130, 76), rgb(152, 144, 96), dryness);
  return blend(stubble, rgb(178, 164, 116), 0.6F * straw) * grass_grain(x, y, 0.5F, layout.seed);
}

Colour soil(float x, float y, std::uint32_t seed) {
  return rgb(136, 114, 88) * (1.0F + 0.3F * fractal_noise(x / 0.7F, y / 0.7F, 4, seed + 51));
}

/// How far the ground is laid bare by a path, and of what.
struct Wear {
  float amount = 0;
  bool gravel = false;
};

Wear wear_of(const MeadowPath& path, float x, float y) {
  const float offset = std::abs(offset_from(path, x, y));
  if (offset > 3.0F) return {};
  const float ragged = 0.22F * fractal_noise(x / 0.8F, y / 0.8F, 3, path.seed);
  switch (path.kind) {
    case MeadowPath::Kind::WheelTracks:
      return {0.85F * (1.0F - smooth_step(0.18F, 0.42F, std::abs(offset - 0.8F) + ragged)), false};
    case MeadowPath::Kind::Footpath:
      return {0.8F * (1.0F - smooth_step(0.2F, 0.5F, offset + ragged)), false};
    case MeadowPath::Kind::Gravel:
      return {1.0F - smooth_step(1.35F, 1.75F, offset + ragged), true};
  }
  return {};
}

/// Molehills: at most one in each square, in colonies. How much of the ground at (x, y) is its soil.
float molehill(float x, float y, std::uint32_t seed) {
  if (fractal_noise(x / 17.0F, y / 17.0F, 2, seed + 61) < 0.2F) return 0;
  constexpr float kSquareM = 2.5F;
  const float cx = std::floor(x / kSquareM);
  const float cy = std::floor(y / kSquareM);
  const float dx = x / kSquareM - cx - 0.5F - 0.25F * value_noise(cx, cy, seed + 62);
  const float dy = y / kSquareM - cy - 0.5F - 0.25F * value_noise(cx, cy, seed + 63);
  const float radius_m = 0.22F + 0.16F * value_noise(cx, cy, seed + 64);
  const float ragged = 0.1F * value_noise(x / 0.2F, y / 0.2F, seed + 65);
  return 1.0F - smooth_step(0.75F, 1.15F, std::hypot(dx, dy) * kSquareM / radius_m + ragged);
}

/// Patches worn bare.
float bareness(float x, float y, std::uint32_t seed) {
  constexpr float kBegin = 0.40F;
  constexpr float kFull = 0.56F;
  // Turned against the axes, along which such noise has its straight edges.
  const float u = (0.8F * x - 0.6F * y) / 8.0F;
  const float v = (0.6F * x + 0.8F * y) / 8.0F;
  // The first octave has 16 of the 31 parts: where it is low, the others cannot make up for it.
  if (16.0F / 31.0F * value_noise(u, v, seed + 72) + 15.0F / 31.0F < kBegin) return 0;
  return smooth_step(kBegin, kFull, fractal_noise(u, v, 5, seed + 72));
}

}  // namespace

float terrain_height(const MeadowLayout& layout, float x, float y) {
  return 2.2F * fractal_noise(x / 70.0F, y / 70.0F, 3, layout.seed + 1) +
         0.12F * value_noise(x / 3.1F, y / 3.1F, layout.seed + 2);
}

Cover cover_at(const MeadowLayout& layout, float x, float y) {
  Cover highest;
  for (const int i : layout.objects_near(x, y)) {
    const auto& object = layout.objects[static_cast<std::size_t>(i)];
    const Eigen::Vector2d offset(x - object.centre.x(), y - object.centre.y());
    if (offset.squaredNorm() > object.radius_m * object.radius_m) continue;
    const float height_m = object_height(object, x, y, layout.seed);
    if (height_m > highest.height_m) highest = {height_m, &object};
  }
  return highest;
}

Colour ground_colour(const MeadowLayout& layout, float x, float y) {
  const std::uint32_t seed = layout.seed;
  const float dryness = smooth_step(-0.45F, 0.5F, fractal_noise(x / 24.0F, y / 24.0F, 3, seed + 71));
  const auto parcel = layout.parcel_at(x, y);
  Colour colour;
  switch (layout.parcels[static_cast<std::size_t>(parcel.index)]) {
    case GroundCover::Pasture:
      colour = pasture(x, y, dryness, seed);
      colour = blend(colour, soil(x, y, seed), molehill(x, y, seed));
      break;
    case GroundCover::Mown:
      colour = mown(layout, parcel.index, x, y, dryness);
      break;
    case GroundCover::Hay:
      colour = hay(layout, parcel.index, x, y, dryness);
      break;
  }
  if (parcel.edge_m < 1.2F) {  // an uncut margin between parcels
    colour = blend(pasture(x, y, 0.3F, seed + 3) * 0.85F, colour, smooth_step(0.4F, 1.2F, parcel.edge_m));
  }
  const float bare = bareness(x, y, seed);
  if (bare > 0) colour = blend(colour, soil(x, y, seed), 0.7F * bare);
  for (const auto& path : layout.paths) {
    const Wear wear = wear_of(path, x, y);
    if (wear.amount <= 0) continue;
    const float pebbles = 1.0F + 0.22F * fractal_noise(x / 0.16F, y / 0.16F, 2, seed + 73);
    colour = blend(colour, wear.gravel ? Colour(rgb(168, 160, 148) * pebbles) : soil(x, y, seed), wear.amount);
  }
  return colour;
}

Colour object_colour(const MeadowLayout& layout, const Cover& cover, float x, float y) {
  const auto& object = *cover.object;
  const float own = 1.0F + 0.14F * object.tint;
  switch (object.kind) {
    case MeadowObject::Kind::Tree:
    case MeadowObject::Kind::Bush: {
      const float leaves = fractal_noise(x / 0.45F, y / 0.45F, 3, layout.seed + 81);
      const float height = std::min(1.0F, cover.height_m / static_cast<float>(object.height_m));
      return blend(rgb(58, 78, 42), rgb(92, 104, 52), 0.5F + 0.5F * object.tint) * own * (0.85F + 0.35F * height + 0.7F * leaves);
    }
    case MeadowObject::Kind::Bale:
      return rgb(186, 168, 112) * own * (1.0F + 0.25F * fractal_noise(x / 0.3F, y / 0.3F, 2, layout.seed + 82));
    case MeadowObject::Kind::Shed: {
      const float sheet = in_shed(object, x, y).x();
      const float corrugation = 1.0F + 0.05F * std::sin(sheet * 2.0F * static_cast<float>(kPi) / 0.3F);
      const float rust = smooth_step(-0.1F, 0.5F, fractal_noise(x / 1.3F, y / 1.3F, 3, layout.seed + 83));
      return blend(rgb(158, 156, 152), rgb(142, 98, 72), rust) * corrugation;
    }
  }
  return {};
}

}  // namespace fabloop
