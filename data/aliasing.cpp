// SPDX-License-Identifier: BSD-3-Clause
#include "data/aliasing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "data/noise.h"
#include "data/random.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kBorderM = 2.0;

/// A tile of the ground and the way from it to what it is a copy of.
class Tiles {
 public:
  Tiles(const GroundArea& area, const AliasingOptions& options) : area_(area) {
    const Eigen::Vector2d count = ((area.max - area.min) / options.tile_m).array().round().max(1.0);
    ground_.num_columns = static_cast<std::size_t>(count.x());
    ground_.num_rows = static_cast<std::size_t>(count.y());
    size_ = (area.max - area.min).cwiseQuotient(count);
    const std::size_t num_tiles = ground_.num_columns * ground_.num_rows;
    if (num_tiles < 2) {
      throw InputError("aliasing: the ground has room for one tile of " + std::to_string(options.tile_m) +
                       " m; ask for smaller tiles or a longer flight");
    }
    choose_copies(num_tiles, options);
  }

  const AliasedGround& ground() const { return ground_; }

  /// The point that (x, y) is a copy of, and how much of a copy it is, in (0, 1]; none where it is itself.
  struct Source {
    Eigen::Vector2d point;
    float blend = 1.0F;
  };
  std::optional<Source> source_of(double x, double y) const {
    const Eigen::Vector2d at = (Eigen::Vector2d(x, y) - area_.min).cwiseQuotient(size_);
    const auto column = index(at.x(), ground_.num_columns), row = index(at.y(), ground_.num_rows);
    const std::optional<std::size_t>& source = source_[row * ground_.num_columns + column];
    if (!source) return std::nullopt;
    const Eigen::Vector2d inside =
        (at - Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row))).cwiseProduct(size_);
    const double edge_m = std::min(inside.minCoeff(), (size_ - inside).minCoeff());
    const Eigen::Vector2d corner(static_cast<double>(*source % ground_.num_columns),
                                 static_cast<double>(*source / ground_.num_columns));
    return Source{area_.min + corner.cwiseProduct(size_) + inside,
                  smooth_step(0.0F, static_cast<float>(kBorderM), static_cast<float>(edge_m))};
  }

 private:
  static std::size_t index(double position, std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, position)));
  }

  void choose_copies(std::size_t num_tiles, const AliasingOptions& options) {
    // In one order for all shares: the first ones become copies, the others stay and are copied.
    std::vector<std::size_t> order(num_tiles);
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random random(options.seed, 0xA11A5);
    for (std::size_t i = num_tiles - 1; i > 0; --i) std::swap(order[i], order[random.bits() % (i + 1)]);
    const auto num_copies =
        std::min(num_tiles - 1, static_cast<std::size_t>(std::lround(options.share * static_cast<double>(num_tiles))));
    source_.resize(num_tiles);
    for (std::size_t i = 0; i < num_copies; ++i) {
      const std::size_t num_sources = num_tiles - num_copies;
      source_[order[i]] = order[num_tiles - 1 - i % num_sources];
    }
    for (std::size_t tile = 0; tile < num_tiles; ++tile) {
      if (source_[tile]) ground_.copies.emplace_back(tile, *source_[tile]);
    }
  }

  GroundArea area_;
  Eigen::Vector2d size_;
  AliasedGround ground_;
  std::vector<std::optional<std::size_t>> source_;
};

void copy_relief(World& world, const Tiles& tiles) {
  HeightMap& surface = world.surface;
  const cv::Mat1f before = surface.heights.clone();
  const HeightMap old{surface.origin, surface.spacing_m, before, {}, 0};
  const auto relief_at = [&](double x, double y) { return height_at(old, x, y) - height_at(world.terrain, x, y); };
  for (int row = 0; row < before.rows; ++row) {
    for (int col = 0; col < before.cols; ++col) {
      const double x = surface.origin.x() + col * surface.spacing_m, y = surface.origin.y() + row * surface.spacing_m;
      const auto source = tiles.source_of(x, y);
      if (!source) continue;
      const double relief = relief_at(source->point.x(), source->point.y());
      const double copied = height_at(world.terrain, x, y) + relief;
      surface.heights(row, col) += source->blend * static_cast<float>(copied - before(row, col));
    }
  }
  update_block_max(surface);
}

void copy_texture(World& world, const Tiles& tiles) {
  cv::Mat3b& texture = world.texture.front();
  const cv::Mat3b before = texture.clone();
  for (int row = 0; row < before.rows; ++row) {
    for (int col = 0; col < before.cols; ++col) {
      const double x = world.area.min.x() + col * world.texture_m_per_px, y = world.area.min.y() + row * world.texture_m_per_px;
      const auto source = tiles.source_of(x, y);
      if (!source) continue;
      const Eigen::Vector2d pixel = (source->point - world.area.min) / world.texture_m_per_px;
      const int source_row = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, before.rows - 1);
      const int source_col = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, before.cols - 1);
      const cv::Vec3b& copied = before(source_row, source_col);
      cv::Vec3b& colour = texture(row, col);
      for (int channel = 0; channel < 3; ++channel) {
        const auto own = static_cast<float>(colour[channel]);
        colour[channel] = cv::saturate_cast<uchar>(own + source->blend * (static_cast<float>(copied[channel]) - own));
      }
    }
  }
  update_texture_levels(world);
}

}  // namespace

double AliasedGround::share() const { return static_cast<double>(copies.size()) / static_cast<double>(num_columns * num_rows); }

AliasedGround alias_ground(World& world, const AliasingOptions& options) {
  if (!(options.share >= 0.0 && options.share < 1.0)) throw InputError("aliasing: the share must be in [0, 1)");
  if (!(options.tile_m >= 2.0 * kBorderM)) throw InputError("aliasing: tiles must be at least 4 m wide");
  const Tiles tiles(world.area, options);
  if (tiles.ground().copies.empty()) return tiles.ground();
  copy_relief(world, tiles);
  copy_texture(world, tiles);
  return tiles.ground();
}

}  // namespace fabloop
