// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/mosaic_blocks.h"

#include <algorithm>
#include <cmath>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// What is the same for all blocks.
struct Look {
  const HeightField& surface;
  const std::vector<GroundView>& views;
  ImageCache& images;
  double flying_height;
  double least_cosine;  ///< Of a ray's angle with the vertical, to count.
  double highest;
};

struct Seen {
  std::uint32_t view;
  double quality;
  Eigen::Vector2d pixel;
};

std::vector<Seen> seen_from(const Look& look, const std::vector<std::uint32_t>& candidates, const Eigen::Vector3d& x) {
  std::vector<Seen> seen;
  for (const std::uint32_t view : candidates) {
    if (const auto pixel = look.views[view].pixel_of(x)) {
      seen.push_back({view, look.views[view].quality(x, *pixel, look.flying_height), *pixel});
    }
  }
  const auto better = [](const Seen& a, const Seen& b) {
    return a.quality > b.quality || (a.quality == b.quality && a.view < b.view);
  };
  std::sort(seen.begin(), seen.end(), better);
  constexpr std::size_t kLookedAt = 2 * MosaicBlocks::kMaxViews;
  if (seen.size() > kLookedAt) seen.resize(kLookedAt);
  constexpr double kHidden = 0.05;
  const double tolerance = 2 * look.surface.grid.spacing;
  for (Seen& s : seen) {
    if (!is_visible(look.surface, look.highest, x, look.views[s.view].centre(), tolerance)) s.quality *= kHidden;
  }
  std::sort(seen.begin(), seen.end(), better);
  if (seen.size() > MosaicBlocks::kMaxViews) seen.resize(MosaicBlocks::kMaxViews);
  return seen;
}

/// Mean colour over the 3 x 3 nearest pixels of a level on which a pixel is about a third of a block.
cv::Vec3b mean_colour(const cv::Mat3b& image, const Eigen::Vector2d& at) {
  const auto column = static_cast<int>(std::lround(at.x()));
  const auto row = static_cast<int>(std::lround(at.y()));
  cv::Vec3i sum(0, 0, 0);
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = column - 1; c <= column + 1; ++c) {
      const cv::Vec3b& p = image(std::clamp(r, 0, image.rows - 1), std::clamp(c, 0, image.cols - 1));
      for (int k = 0; k < 3; ++k) sum[k] += p[k];
    }
  }
  cv::Vec3b mean;
  for (int k = 0; k < 3; ++k) mean[k] = static_cast<std::uint8_t>((sum[k] + 4) / 9);
  return mean;
}

/// Views that may show anything of a rectangle of blocks: they show one of a lattice of its points, with a margin.
std::vector<std::uint32_t> candidates_for(const Look& look, const GroundGrid& grid, const cv::Rect& part) {
  std::vector<std::uint32_t> candidates;
  constexpr int kSamples = 9;
  for (std::uint32_t v = 0; v < look.views.size(); ++v) {
    const Camera& camera = look.views[v].camera();
    bool shows = false;
    for (int i = 0; i < kSamples * kSamples && !shows; ++i) {
      const double column = part.x + (part.width - 1) * (i % kSamples) / (kSamples - 1.0);
      const double row = part.y + (part.height - 1) * (i / kSamples) / (kSamples - 1.0);
      const Eigen::Vector2d x = grid.ground_at(column, row);
      const auto pixel = look.views[v].project({x.x(), x.y(), height_at(look.surface, x)});
      constexpr double kBorderShare = 0.1;
      shows = pixel && pixel->x() > -kBorderShare * camera.width && pixel->x() < (1 + kBorderShare) * camera.width &&
              pixel->y() > -kBorderShare * camera.height && pixel->y() < (1 + kBorderShare) * camera.height;
    }
    if (shows) candidates.push_back(v);
  }
  return candidates;
}

void look_at_part(const Look& look, const cv::Rect& part, MosaicBlocks& blocks) {
  const std::vector<std::uint32_t> candidates = candidates_for(look, blocks.grid, part);
  std::vector<std::shared_ptr<const ImagePyramid>> pyramids(look.views.size());
  for (const std::uint32_t view : candidates) pyramids[view] = look.images.get(look.views[view].image());
  for (int row = part.y; row < part.y + part.height; ++row) {
    for (int column = part.x; column < part.x + part.width; ++column) {
      const std::size_t block = static_cast<std::size_t>(row) * blocks.grid.columns + column;
      const Eigen::Vector2d x = blocks.grid.ground_at(column, row);
      const Eigen::Vector3d point(x.x(), x.y(), height_at(look.surface, x));
      for (const std::uint32_t view : candidates) {
        const Eigen::Vector3d way = look.views[view].centre() - point;
        if (way.z() < look.least_cosine * way.norm()) continue;
        blocks.num_seeing[block] += look.views[view].pixel_of(point).has_value();
      }
      for (const Seen& seen : seen_from(look, candidates, point)) {
        const GroundView& view = look.views[seen.view];
        const double sampling = (view.centre() - point).norm() / view.camera().focal_px();
        const int level = pyramid_level(blocks.grid.spacing / 3, sampling);
        const ImagePyramid& pyramid = *pyramids[seen.view];
        blocks.entries[block * MosaicBlocks::kMaxViews + blocks.num_views[block]++] = {
            seen.view, static_cast<float>(seen.quality), static_cast<float>(image_radius(view.camera(), seen.pixel)),
            mean_colour(pyramid.colour[level], pyramid.on_level(seen.pixel, level))};
      }
    }
  }
}

}  // namespace

double image_radius(const Camera& camera, const Eigen::Vector2d& pixel) {
  const double x = std::max(camera.cx, camera.width - 1 - camera.cx);
  const double y = std::max(camera.cy, camera.height - 1 - camera.cy);
  return std::hypot(pixel.x() - camera.cx, pixel.y() - camera.cy) / std::hypot(x, y);
}

int pyramid_level(double spacing, double ground_sampling) {
  const double octaves = std::floor(std::log2(spacing / ground_sampling) + 0.25);
  return static_cast<int>(std::clamp(octaves, 0.0, ImagePyramid::kLevels - 1.0));
}

MosaicBlocks look_at_blocks(const GroundGrid& mosaic, const HeightField& surface, const std::vector<GroundView>& views,
                            ImageCache& images, double flying_height, double max_slant_deg, int num_threads) {
  MosaicBlocks blocks;
  blocks.grid = coarser(mosaic, MosaicBlocks::kSide);
  const std::size_t count = static_cast<std::size_t>(blocks.grid.rows) * blocks.grid.columns;
  blocks.entries.resize(count * MosaicBlocks::kMaxViews);
  blocks.num_views.resize(count);
  blocks.num_seeing.resize(count);
  double highest = 0;
  cv::minMaxLoc(surface.heights, nullptr, &highest);
  const Look look{surface, views, images, flying_height, std::cos(rad_from_deg(max_slant_deg)), highest};
  constexpr int kPart = 24;
  const int parts_across = (blocks.grid.columns + kPart - 1) / kPart;
  const int parts_down = (blocks.grid.rows + kPart - 1) / kPart;
  parallel_for(static_cast<std::size_t>(parts_across) * parts_down, num_threads, [&](std::size_t i) {
    const int column = static_cast<int>(i) % parts_across * kPart;
    const int row = static_cast<int>(i) / parts_across * kPart;
    const cv::Rect all(0, 0, blocks.grid.columns, blocks.grid.rows);
    look_at_part(look, cv::Rect(column, row, kPart, kPart) & all, blocks);
  });
  return blocks;
}

}  // namespace fabloop
