// SPDX-License-Identifier: BSD-3-Clause
#include "data/meadow_layout.h"

#include <algorithm>
#include <cmath>

#include "data/noise.h"
#include "data/random.h"

namespace fabloop {
namespace {

/// Boundaries of parcels are not straight.
constexpr float kBoundaryWanderM = 3.0F;
constexpr float kBoundaryWavelengthM = 37.0F;

float boundary_x(const MeadowLayout& layout, float y) {
  return static_cast<float>(layout.corner.x()) +
         kBoundaryWanderM * static_cast<float>(line_noise(y / kBoundaryWavelengthM, layout.seed + 11));
}

float boundary_y(const MeadowLayout& layout, float x) {
  return static_cast<float>(layout.corner.y()) +
         kBoundaryWanderM * static_cast<float>(line_noise(x / kBoundaryWavelengthM, layout.seed + 12));
}

Eigen::Vector2d anywhere(const GroundArea& area, Random& random) {
  return {random.uniform(area.min.x(), area.max.x()), random.uniform(area.min.y(), area.max.y())};
}

void add(MeadowLayout& layout, MeadowObject::Kind kind, const Eigen::Vector2d& centre, double radius_m, double height_m,
         Random& random) {
  MeadowObject object;
  object.kind = kind;
  object.centre = centre;
  object.radius_m = radius_m;
  object.height_m = height_m;
  object.heading_rad = random.uniform(0, kPi);
  object.tint = static_cast<float>(random.uniform(-1, 1));
  layout.objects.push_back(object);
}

/// Bushes in a row along one arm of the parcels' cross, with gaps.
void add_hedge(MeadowLayout& layout, bool along_x, double from, double to, Random& random) {
  const std::uint32_t gaps = static_cast<std::uint32_t>(random.bits());
  for (double s = from; s < to; s += random.uniform(0.7, 1.3)) {
    if (line_noise(s / 14.0, gaps) > 0.35) continue;
    const auto along = static_cast<float>(s);
    const Eigen::Vector2d on_line =
        along_x ? Eigen::Vector2d(s, boundary_y(layout, along)) : Eigen::Vector2d(boundary_x(layout, along), s);
    const Eigen::Vector2d jitter(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    const double radius_m = random.uniform(0.7, 1.5);
    add(layout, MeadowObject::Kind::Bush, on_line + jitter, radius_m, 1.3 * radius_m, random);
    if (random.uniform() < 0.05)
      add(layout, MeadowObject::Kind::Tree, on_line, random.uniform(1.8, 3.2), random.uniform(4, 7), random);
  }
}

void add_trees(MeadowLayout& layout, Random& random) {
  const Eigen::Vector2d size = layout.area.max - layout.area.min;
  const auto count = static_cast<int>(size.x() * size.y() / 1500.0);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d centre = anywhere(layout.area, random);
    const bool grove = random.uniform() < 0.15;
    const int members = grove ? 4 : 1;
    for (int k = 0; k < members; ++k) {
      const Eigen::Vector2d offset(grove ? random.uniform(-5, 5) : 0, grove ? random.uniform(-5, 5) : 0);
      const double radius_m = random.uniform(0.9, 3.4);
      const bool is_bush = radius_m < 1.5;
      add(layout, is_bush ? MeadowObject::Kind::Bush : MeadowObject::Kind::Tree, centre + offset, radius_m,
          is_bush ? 1.2 * radius_m : random.uniform(1.4, 2.0) * radius_m + 1.0, random);
    }
  }
}

void add_bales(MeadowLayout& layout, Random& random) {
  const Eigen::Vector2d size = layout.area.max - layout.area.min;
  const auto tries = static_cast<int>(size.x() * size.y() / 250.0);
  for (int i = 0; i < tries; ++i) {
    const Eigen::Vector2d centre = anywhere(layout.area, random);
    const auto parcel = layout.parcel_at(static_cast<float>(centre.x()), static_cast<float>(centre.y()));
    if (layout.parcels[parcel.index] != GroundCover::Hay || parcel.edge_m < 4) continue;
    add(layout, MeadowObject::Kind::Bale, centre, 0.75, 1.3, random);
  }
}

void add_paths(MeadowLayout& layout, Random& random) {
  const Eigen::Vector2d middle = 0.5 * (layout.area.min + layout.area.max);
  const Eigen::Vector2d size = layout.area.max - layout.area.min;
  const double first_heading = random.uniform(0.15, 0.6) * random.sign();
  const std::vector<std::pair<MeadowPath::Kind, double>> kinds = {
      {MeadowPath::Kind::WheelTracks, first_heading},
      {MeadowPath::Kind::Footpath, first_heading + random.uniform(0.9, 1.6)},
      {MeadowPath::Kind::Gravel, random.uniform(-0.1, 0.1) + kPi / 2}};
  for (const auto& [kind, heading] : kinds) {
    MeadowPath path;
    path.kind = kind;
    // The gravel road runs at the side; the others cross the middle.
    const double side = kind == MeadowPath::Kind::Gravel ? random.sign() * 0.27 : random.uniform(-0.1, 0.1);
    path.point = middle + Eigen::Vector2d(side * size.x(), random.uniform(-0.1, 0.1) * size.y());
    path.direction = {std::cos(heading), std::sin(heading)};
    path.wander_m = kind == MeadowPath::Kind::Gravel ? 2.5 : 7;
    path.seed = static_cast<std::uint32_t>(random.bits());
    layout.paths.push_back(path);
  }
}

void fill_buckets(MeadowLayout& layout) {
  const Eigen::Vector2d size = layout.area.max - layout.area.min;
  layout.bucket_cols = static_cast<int>(size.x() / MeadowLayout::kBucketM) + 1;
  const int rows = static_cast<int>(size.y() / MeadowLayout::kBucketM) + 1;
  layout.buckets.assign(static_cast<std::size_t>(layout.bucket_cols) * rows, {});
  for (std::size_t i = 0; i < layout.objects.size(); ++i) {
    const auto& object = layout.objects[i];
    const auto bucket = [](double metres, int count) {
      return std::clamp(static_cast<int>(metres / MeadowLayout::kBucketM), 0, count - 1);
    };
    const Eigen::Vector2d low = object.centre.array() - object.radius_m - layout.area.min.array();
    const Eigen::Vector2d high = object.centre.array() + object.radius_m - layout.area.min.array();
    for (int row = bucket(low.y(), rows); row <= bucket(high.y(), rows); ++row) {
      for (int col = bucket(low.x(), layout.bucket_cols); col <= bucket(high.x(), layout.bucket_cols); ++col) {
        layout.buckets[static_cast<std::size_t>(row) * layout.bucket_cols + col].push_back(static_cast<int>(i));
      }
    }
  }
}

}  // namespace

const std::vector<int>& MeadowLayout::objects_near(double x, double y) const {
  const auto col = static_cast<std::size_t>(std::clamp((x - area.min.x()) / kBucketM, 0.0, bucket_cols - 1.0));
  const auto rows = static_cast<double>(buckets.size()) / bucket_cols;
  const auto row = static_cast<std::size_t>(std::clamp((y - area.min.y()) / kBucketM, 0.0, rows - 1.0));
  return buckets[row * bucket_cols + col];
}

MeadowLayout::Parcel MeadowLayout::parcel_at(float x, float y) const {
  const float east = x - boundary_x(*this, y);
  const float north = y - boundary_y(*this, x);
  return {(east > 0 ? 1 : 0) + (north > 0 ? 2 : 0), std::min(std::abs(east), std::abs(north))};
}

float offset_from(const MeadowPath& path, float x, float y) {
  const float dx = x - static_cast<float>(path.point.x());
  const float dy = y - static_cast<float>(path.point.y());
  const auto cos = static_cast<float>(path.direction.x());
  const auto sin = static_cast<float>(path.direction.y());
  const double along = dx * cos + dy * sin;
  const auto wander = static_cast<float>(path.wander_m * line_noise(along / 45.0, path.seed));
  return -dx * sin + dy * cos - wander;
}

MeadowLayout plan_meadow(const GroundArea& area, std::uint64_t seed) {
  Random random(seed, 0x3EAD0);
  MeadowLayout layout;
  layout.area = area;
  layout.seed = static_cast<std::uint32_t>(random.bits());
  const Eigen::Vector2d size = area.max - area.min;
  layout.corner =
      0.5 * (area.min + area.max) + 0.12 * Eigen::Vector2d(random.uniform(-1, 1) * size.x(), random.uniform(-1, 1) * size.y());
  layout.parcels = {GroundCover::Pasture, GroundCover::Mown, GroundCover::Hay, GroundCover::Pasture};
  std::rotate(layout.parcels.begin(), layout.parcels.begin() + static_cast<int>(random.uniform(0, 4)), layout.parcels.end());
  for (int i = 0; i < 4; ++i) layout.row_heading_rad.push_back(random.uniform(0, kPi));
  add_paths(layout, random);
  add_hedge(layout, true, area.min.x(), layout.corner.x(), random);
  add_hedge(layout, false, layout.corner.y(), area.max.y(), random);
  add_trees(layout, random);
  add_bales(layout, random);
  const Eigen::Vector2d shed_offset(random.sign() * random.uniform(8, 14), random.sign() * random.uniform(6, 10));
  add(layout, MeadowObject::Kind::Shed, layout.corner + shed_offset, 4.5, 3.6, random);
  fill_buckets(layout);
  return layout;
}

}  // namespace fabloop
