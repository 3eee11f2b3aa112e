// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "data/world.h"

namespace fabloop {

/// How much of a world looks like other parts of it.
struct AliasingOptions {
  std::uint64_t seed = 1;
  /// Share of the ground that is a copy of other ground, in [0, 1). 0: none.
  double share = 0.0;
  /// Side of the copied squares. About what a picture shows: smaller ones are seen with what is around them, which gives them
  /// away.
  double tile_m = 40.0;
};

/// What was copied where: the ground is divided into a grid of tiles of equal size, numbered row by row from the south-west.
struct AliasedGround {
  std::size_t num_columns = 0, num_rows = 0;
  std::vector<std::pair<std::size_t, std::size_t>> copies;  ///< (tile, the tile that it is a copy of), in the order of tiles.

  /// Share of the ground that is a copy: the wanted one to the nearest tile.
  double share() const;
};

/// Perceptual aliasing: makes tiles of the ground, chosen by chance, look like other tiles, which are no copies: their texture
/// (light and shadows with it) and what rises above the bare ground. Over two metres at their borders copies fade into what was
/// there. The bare ground keeps its height. A larger share with the same seed copies the same tiles and more. Throws InputError
/// for a share outside [0, 1), and for tiles too large to have two of.
AliasedGround alias_ground(World& world, const AliasingOptions& options);

}  // namespace fabloop
