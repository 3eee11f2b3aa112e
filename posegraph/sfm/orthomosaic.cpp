// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/orthomosaic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <opencv2/stitching/detail/blenders.hpp>

#include "frontend/parallel.h"
#include "posegraph/sfm/seam_residual.h"
#include "posegraph/sfm/view_patch.h"
#include "verification/median.h"

namespace fabloop {
namespace {

constexpr int kTile = 512;

/// Blocks that enough views show, without tongues and islands that are narrower than a twentieth of the flying height (unless
/// there is nothing else).
cv::Mat1b well_shown_blocks(const MosaicBlocks& blocks, int min_views, double flying_height) {
  cv::Mat1b shown(blocks.grid.rows, blocks.grid.columns, static_cast<unsigned char>(0));
  for (int row = 0; row < shown.rows; ++row) {
    for (int column = 0; column < shown.cols; ++column) {
      if (blocks.num_seeing[static_cast<std::size_t>(row) * shown.cols + column] >= min_views) shown(row, column) = 255;
    }
  }
  constexpr double kNarrowest = 0.05;
  const int side = 1 + 2 * static_cast<int>(std::lround(0.5 * kNarrowest * flying_height / blocks.grid.spacing));
  cv::Mat1b opened;
  cv::morphologyEx(shown, opened, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  return cv::countNonZero(opened) > 0 ? opened : shown;
}

/// The same, and the holes in it that any view shows.
cv::Mat1b shown_blocks(const MosaicBlocks& blocks, int min_views, double flying_height) {
  cv::Mat1b shown = well_shown_blocks(blocks, min_views, flying_height);
  // A frame of one block around, so that the outside is one region.
  cv::Mat1b unshown(shown.rows + 2, shown.cols + 2, static_cast<unsigned char>(255));
  cv::Mat(shown == 0).copyTo(unshown(cv::Rect(1, 1, shown.cols, shown.rows)));
  cv::Mat1i regions;
  cv::connectedComponents(unshown, regions, 4, CV_32S);
  for (int row = 0; row < shown.rows; ++row) {
    for (int column = 0; column < shown.cols; ++column) {
      const bool is_hole = unshown(row + 1, column + 1) != 0 && regions(row + 1, column + 1) != regions(0, 0);
      if (is_hole && blocks.num_seeing[static_cast<std::size_t>(row) * shown.cols + column] > 0) shown(row, column) = 255;
    }
  }
  return shown;
}

/// Values of blocks at the pixels of a part, bilinear.
cv::Mat at_pixels(const cv::Mat& of_blocks, const cv::Rect& part) {
  cv::Mat1f map_x(part.size()), map_y(part.size());
  cv::Mat result;
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      map_x(row, column) = (static_cast<float>(part.x + column) + 0.5F) / MosaicBlocks::kSide - 0.5F;
      map_y(row, column) = (static_cast<float>(part.y + row) + 0.5F) / MosaicBlocks::kSide - 0.5F;
    }
  }
  cv::remap(of_blocks, result, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

/// As wide as an image's longer side on the ground, as most views have it.
double usual_image_width(const std::vector<GroundView>& views, double flying_height) {
  std::vector<double> widths;
  for (const GroundView& view : views) {
    const Camera& camera = view.camera();
    widths.push_back(flying_height * std::max(camera.width, camera.height) / camera.focal_px());
  }
  return median(std::move(widths));
}

cv::Mat3f drift_factors_of(const MosaicBlocks& blocks, const Exposure& exposure, const std::vector<GroundView>& views,
                           double flying_height) {
  std::vector<Eigen::Vector2d> places;
  for (const GroundView& view : views) places.emplace_back(view.centre().head<2>());
  return drift_factors(exposure, places, blocks.grid, usual_image_width(views, flying_height));
}

/// The view of each pixel of a part (-1: none): blocks' choices with their stairs smoothed.
cv::Mat1i views_of_pixels(const MosaicScene& scene, const cv::Rect& part) {
  const int side = MosaicBlocks::kSide;
  const cv::Rect all(0, 0, scene.blocks.grid.columns, scene.blocks.grid.rows);
  const cv::Rect around = cv::Rect(part.x / side - 1, part.y / side - 1, part.width / side + 3, part.height / side + 3) & all;
  std::map<int, cv::Mat1f> share;
  for (int row = around.y; row < around.y + around.height; ++row) {
    for (int column = around.x; column < around.x + around.width; ++column) {
      const auto block = static_cast<std::size_t>(row) * scene.blocks.grid.columns + column;
      const auto view = scene.shown(row, column) ? static_cast<int>(scene.seams.view_of(scene.blocks, block)) : -1;
      cv::Mat1f& its = share[view];
      if (its.empty()) its = cv::Mat1f(around.size(), 0.0F);
      its(row - around.y, column - around.x) = 1;
    }
  }
  const cv::Rect shifted(part.x - around.x * side, part.y - around.y * side, part.width, part.height);
  cv::Mat1i views(part.size(), -1);
  cv::Mat1f largest(part.size(), 0.0F);
  for (const auto& [view, blocks] : share) {
    const cv::Mat1f here = at_pixels(blocks, shifted);
    for (int row = 0; row < part.height; ++row) {
      for (int column = 0; column < part.width; ++column) {
        if (here(row, column) <= largest(row, column)) continue;
        largest(row, column) = here(row, column);
        views(row, column) = view;
      }
    }
  }
  return views;
}

void make_tile(const MosaicScene& scene, const cv::Rect& kept, int num_bands, Orthomosaic& mosaic) {
  const int halo = 4 << num_bands;  // what a seam reaches in the coarsest band
  const cv::Rect tile = cv::Rect(kept.x - halo, kept.y - halo, kept.width + 2 * halo, kept.height + 2 * halo) &
                        cv::Rect(0, 0, scene.grid.columns, scene.grid.rows);
  const cv::Mat1i views = views_of_pixels(scene, tile);
  std::map<int, cv::Rect> boxes;
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) boxes[views(row, column)] |= cv::Rect(column, row, 1, 1);
  }
  boxes.erase(-1);
  if (boxes.empty()) return;
  const cv::Mat1f heights = heights_of(scene.surface, scene.grid, tile);
  cv::detail::MultiBandBlender blender(0, num_bands, CV_32F);
  blender.prepare(cv::Rect(0, 0, tile.width, tile.height));
  for (const auto& [view, box] : boxes) {
    const cv::Rect wide = cv::Rect(box.x - halo, box.y - halo, box.width + 2 * halo, box.height + 2 * halo) &
                          cv::Rect(0, 0, tile.width, tile.height);
    const cv::Rect part(tile.x + wide.x, tile.y + wide.y, wide.width, wide.height);
    const auto index = static_cast<std::size_t>(view);
    const auto pyramid = scene.images.get(scene.views[index].image());
    cv::Mat3s patch;
    lay_view(scene.grid, part, heights(wide), scene.views[index], *pyramid, scene.exposure, index, scene.camera_of[index])
        .convertTo(patch, CV_16S);
    blender.feed(patch, views(wide) == view, wide.tl());
  }
  cv::Mat blended, mask;
  blender.blend(blended, mask);
  const cv::Rect inner(kept.x - tile.x, kept.y - tile.y, kept.width, kept.height);
  cv::Mat colour;
  blended(inner).convertTo(colour, CV_32F);
  colour = colour.mul(at_pixels(scene.drift_factors, kept));
  colour.convertTo(colour, CV_8U);
  const cv::Mat shown = views(inner) >= 0;
  colour.copyTo(mosaic.colour(kept), shown);
  shown.copyTo(mosaic.shown(kept));
}

}  // namespace

Orthomosaic make_orthomosaic(const GroundGrid& grid, const HeightField& surface, const std::vector<GroundView>& views,
                             const std::vector<std::size_t>& camera_of, std::size_t num_cameras, ImageCache& images,
                             double flying_height, const OrthomosaicOptions& options) {
  const MosaicBlocks blocks =
      look_at_blocks(grid, surface, views, images, flying_height, options.max_slant_deg, options.num_threads);
  const Exposure exposure = equalise_exposure(blocks, camera_of, num_cameras);
  const Seams seams = find_seams(blocks, exposure, camera_of, options.seams);
  const cv::Mat1b shown = shown_blocks(blocks, options.min_views, flying_height);
  const cv::Mat3f drift = drift_factors_of(blocks, exposure, views, flying_height);
  const MosaicScene scene{grid, surface, views, camera_of, images, blocks, exposure, seams, shown, drift};
  Orthomosaic mosaic{grid,
                     cv::Mat3b(grid.rows, grid.columns, cv::Vec3b(0, 0, 0)),
                     cv::Mat1b(grid.rows, grid.columns, static_cast<unsigned char>(0)),
                     {}};
  std::vector<cv::Rect> tiles;
  for (int row = 0; row < grid.rows; row += kTile) {
    for (int column = 0; column < grid.columns; column += kTile) {
      tiles.emplace_back(column, row, std::min(kTile, grid.columns - column), std::min(kTile, grid.rows - row));
    }
  }
  std::mutex mutex;
  std::size_t num_done = 0;
  parallel_for(tiles.size(), options.num_threads, [&](std::size_t i) {
    make_tile(scene, tiles[i], options.num_bands, mosaic);
    const std::scoped_lock lock(mutex);
    if (options.progress) options.progress("orthomosaic", ++num_done, tiles.size());
  });
  mosaic.residual = measure_seams(scene, options.num_threads);
  return mosaic;
}

}  // namespace fabloop
