// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "data/meadow_layout.h"

namespace fabloop {

/// Colour before light falls on it: blue, green, red in [0, 255].
using Colour = Eigen::Vector3f;

/// Height of the bare ground at world (x, y), metres: gentle undulation of 1-3 m around 0.
float terrain_height(const MeadowLayout& layout, float x, float y);

/// What stands highest at world (x, y): height above the ground (0: nothing) and which object.
struct Cover {
  float height_m = 0;
  const MeadowObject* object = nullptr;
};
Cover cover_at(const MeadowLayout& layout, float x, float y);

/// Colour of the ground, as if nothing stood on it.
Colour ground_colour(const MeadowLayout& layout, float x, float y);

/// Colour of an object where it covers world (x, y) at a height above the ground.
Colour object_colour(const MeadowLayout& layout, const Cover& cover, float x, float y);

}  // namespace fabloop
