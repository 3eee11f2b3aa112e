// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "data/world.h"

namespace fabloop {

/// How the ground of a parcel is used.
enum class GroundCover { Pasture, Mown, Hay };

/// What rises above the ground: everything of it is within `radius_m` of `centre`.
struct MeadowObject {
  enum class Kind { Tree, Bush, Bale, Shed };
  Kind kind = Kind::Tree;
  Eigen::Vector2d centre = {0, 0};
  double radius_m = 2;
  double height_m = 4;
  double heading_rad = 0;  ///< Of the shed's ridge, from x to y.
  float tint = 0;          ///< In [-1, 1]: its own shade of the kind's colour.
};

/// A path: a line that wanders.
struct MeadowPath {
  enum class Kind { WheelTracks, Footpath, Gravel };
  Kind kind = Kind::WheelTracks;
  Eigen::Vector2d point = {0, 0};      ///< On its straight course.
  Eigen::Vector2d direction = {1, 0};  ///< Unit length.
  double wander_m = 4;
  std::uint32_t seed = 0;
};

/// Where everything is in a meadow, before anything is drawn: what make_meadow() bakes.
struct MeadowLayout {
  std::uint32_t seed = 0;
  Eigen::Vector2d corner = {0, 0};      ///< Where four parcels meet.
  std::vector<GroundCover> parcels;     ///< Four: south-west, south-east, north-west, north-east of `corner`.
  std::vector<double> row_heading_rad;  ///< Of each parcel's mowing, from x to y.
  std::vector<MeadowPath> paths;
  std::vector<MeadowObject> objects;
  std::vector<std::vector<int>> buckets;  ///< Objects near each square of kBucketM metres, row by row.
  GroundArea area;
  int bucket_cols = 0;

  static constexpr double kBucketM = 8;

  /// Objects that may stand at world (x, y).
  const std::vector<int>& objects_near(double x, double y) const;

  /// Number of the parcel at world (x, y); `edge_m` is how far its boundary is.
  struct Parcel {
    int index;
    float edge_m;
  };
  Parcel parcel_at(float x, float y) const;
};

/// Scatters parcels, paths, hedges, trees, bales and a shed over `area`, whose middle is where the camera will fly.
MeadowLayout plan_meadow(const GroundArea& area, std::uint64_t seed);

/// Signed distance in metres of world (x, y) from the middle of a path.
float offset_from(const MeadowPath& path, float x, float y);

}  // namespace fabloop
