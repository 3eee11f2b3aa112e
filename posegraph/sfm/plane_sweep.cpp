// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/plane_sweep.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "frontend/parallel.h"
#include "posegraph/sfm/semi_global.h"

namespace fabloop {
namespace {

/// What a sweep is given, once for all tiles.
struct Sweep {
  const HeightField& base;
  const std::vector<GroundView>& views;
  ImageCache& images;
  int num_steps;  ///< Heights tried below and above the base each.
  double step;
  int level;
  double flying_height;
  const PlaneSweepOptions& options;
};

/// The views best for a tile: those that show most of it best, and from different places.
std::vector<std::size_t> choose_views(const Sweep& sweep, const cv::Rect& tile) {
  struct Candidate {
    std::size_t view;
    double quality;
    Eigen::Vector3d direction;
  };
  const GroundGrid& grid = sweep.base.grid;
  const auto point_at = [&](double column, double row) {
    const Eigen::Vector2d x = grid.ground_at(column, row);
    return Eigen::Vector3d(x.x(), x.y(), height_at(sweep.base, x));
  };
  const Eigen::Vector3d middle = point_at(tile.x + 0.5 * tile.width, tile.y + 0.5 * tile.height);
  std::vector<Candidate> candidates;
  for (std::size_t v = 0; v < sweep.views.size(); ++v) {
    double quality = 0;
    constexpr int kSamples = 5;
    for (int i = 0; i < kSamples * kSamples; ++i) {
      const double column = tile.x + (i % kSamples + 0.5) * tile.width / kSamples;
      const double row = tile.y + (i / kSamples + 0.5) * tile.height / kSamples;
      const Eigen::Vector3d x = point_at(column, row);
      if (const auto pixel = sweep.views[v].pixel_of(x)) quality += sweep.views[v].quality(x, *pixel, sweep.flying_height);
    }
    if (quality > 0) candidates.push_back({v, quality, (sweep.views[v].centre() - middle).normalized()});
  }
  std::vector<std::size_t> chosen;
  std::vector<double> newness(candidates.size(), 1.0);
  while (chosen.size() < std::min<std::size_t>(candidates.size(), sweep.options.max_views)) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      if (candidates[i].quality * newness[i] > candidates[best].quality * newness[best]) best = i;
    }
    if (!(candidates[best].quality * newness[best] > 0)) break;
    chosen.push_back(candidates[best].view);
    newness[best] = 0;
    // Two views from one place see no height.
    const double apart = rad_from_deg(8);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double angle = angle_between(candidates[i].direction, candidates[best].direction);
      newness[i] = std::min(newness[i], std::max(0.02, std::min(1.0, angle / apart)) * (newness[i] > 0));
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// A view laid onto the surface: grey values of a tile's cells and their moments over the window.
struct Patch {
  cv::Mat1f grey, mean, variance;
  cv::Mat1b valid;
};

cv::Mat1f window_mean(const cv::Mat1f& values, int window) {
  cv::Mat1f mean;
  cv::boxFilter(values, mean, CV_32F, {window, window}, {-1, -1}, true, cv::BORDER_REFLECT_101);
  return mean;
}

cv::Mat1f product(const cv::Mat1f& a, const cv::Mat1f& b) {
  cv::Mat1f result;
  cv::multiply(a, b, result);
  return result;
}

Patch lay_onto_surface(const Sweep& sweep, const GroundView& view, const ImagePyramid& pyramid, const cv::Rect& tile,
                       double offset) {
  Patch patch;
  cv::Mat1f map_x(tile.size()), map_y(tile.size());
  cv::Mat1b inside(tile.size());
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) {
      const Eigen::Vector2d x = sweep.base.grid.ground_at(tile.x + column, tile.y + row);
      const double height = sweep.base.heights(tile.y + row, tile.x + column) + offset;
      const auto pixel = view.pixel_of({x.x(), x.y(), height});
      inside(row, column) = pixel ? 255 : 0;
      const Eigen::Vector2d at = pixel ? pyramid.on_level(*pixel, sweep.level) : Eigen::Vector2d(-1, -1);
      map_x(row, column) = static_cast<float>(at.x());
      map_y(row, column) = static_cast<float>(at.y());
    }
  }
  cv::Mat1b grey;
  cv::remap(pyramid.grey[sweep.level], grey, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  grey.convertTo(patch.grey, CV_32F, 1.0, -128.0);
  const int window = sweep.options.window;
  patch.mean = window_mean(patch.grey, window);
  cv::subtract(window_mean(product(patch.grey, patch.grey), window), product(patch.mean, patch.mean), patch.variance);
  cv::erode(inside, patch.valid, cv::Mat1b::ones(window, window), {-1, -1}, 1, cv::BORDER_REPLICATE);
  return patch;
}

/// NCC of a pair over the window; -2 where either view does not show it.
cv::Mat1f correlation(const Patch& a, const Patch& b, int window) {
  constexpr float kNoise = 3;  // grey values squared: what is no more than noise must not correlate
  cv::Mat1f result = window_mean(product(a.grey, b.grey), window);
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.cols; ++column) {
      if (!a.valid(row, column) || !b.valid(row, column)) {
        result(row, column) = -2;
        continue;
      }
      const float covariance = result(row, column) - a.mean(row, column) * b.mean(row, column);
      const float variances =
          (std::max(0.0F, a.variance(row, column)) + kNoise) * (std::max(0.0F, b.variance(row, column)) + kNoise);
      result(row, column) = covariance / std::sqrt(variances);
    }
  }
  return result;
}

/// The mean of the better 40 % of the pairs; no agreement where there is no pair.
cv::Mat1f agreement(const std::vector<Patch>& patches, const cv::Size& size, int window) {
  std::vector<cv::Mat1f> pairs;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    for (std::size_t j = i + 1; j < patches.size(); ++j) pairs.push_back(correlation(patches[i], patches[j], window));
  }
  cv::Mat1f result(size, 0.0F);
  std::vector<float> values;
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      values.clear();
      for (const cv::Mat1f& pair : pairs) {
        if (pair(row, column) >= -1.5F) values.push_back(pair(row, column));
      }
      if (values.empty()) continue;
      const std::size_t count = (2 * values.size() + 4) / 5;
      std::partial_sort(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), values.end(), std::greater<>());
      float sum = 0;
      for (std::size_t k = 0; k < count; ++k) sum += values[k];
      result(row, column) = sum / static_cast<float>(count);
    }
  }
  return result;
}

/// The costs with what a height costs for being away from the base: all of it where only two views compare, and a tenth
/// elsewhere, as it would draw hills down where views lie near each other.
CostVolume with_base_trust(const Sweep& sweep, CostVolume costs, const cv::Mat1b& num_views) {
  for (int row = 0; row < costs.rows(); ++row) {
    for (int column = 0; column < costs.columns(); ++column) {
      const float trust = sweep.options.base_trust * (num_views(row, column) < 3 ? 1.0F : 0.1F);
      for (int d = 0; d < costs.choices(); ++d) {
        const auto steps = static_cast<float>(std::abs(d - sweep.num_steps));
        costs.at(row, column)[d] += trust * steps / static_cast<float>(sweep.num_steps);
      }
    }
  }
  return costs;
}

/// How many views show each cell at the base's height.
cv::Mat1b count_views(const std::vector<Patch>& patches, const cv::Size& size) {
  cv::Mat1b count(size, static_cast<unsigned char>(0));
  for (const Patch& patch : patches) count += patch.valid / 255;
  return count;
}

/// Offsets from the base in steps, and how sure they are.
void take_heights(const Sweep& sweep, const CostVolume& costs, const CostVolume& smooth, const cv::Mat1b& num_views,
                  const cv::Rect& tile, const cv::Rect& kept, HeightField& result) {
  for (int row = kept.y; row < kept.y + kept.height; ++row) {
    for (int column = kept.x; column < kept.x + kept.width; ++column) {
      const int r = row - tile.y;
      const int c = column - tile.x;
      const int best = cheapest(smooth, r, c);
      const float ncc = 1 - costs.at(r, c)[best];
      const double offset = (best + refinement(smooth, r, c, best) - sweep.num_steps) * sweep.step;
      const bool at_the_end = best == 0 || best == 2 * sweep.num_steps;
      const float confidence = std::clamp((ncc - 0.3F) / 0.4F, 0.0F, 1.0F);
      constexpr float kFewViews = 0.3F;  // what two views agree on may be chance
      constexpr float kAtTheEnd = 0.2F;  // the true height may lie beyond the range
      const float trust = (at_the_end ? kAtTheEnd : 1.0F) * (num_views(r, c) < 3 ? kFewViews : 1.0F);
      result.heights(row, column) = sweep.base.heights(row, column) + static_cast<float>(offset);
      result.confidence(row, column) = trust * confidence;
    }
  }
}

void sweep_tile(const Sweep& sweep, const cv::Rect& kept, HeightField& result) {
  const GroundGrid& grid = sweep.base.grid;
  const int halo = 16;
  const cv::Rect tile = cv::Rect(kept.x - halo, kept.y - halo, kept.width + 2 * halo, kept.height + 2 * halo) &
                        cv::Rect(0, 0, grid.columns, grid.rows);
  const std::vector<std::size_t> chosen = choose_views(sweep, tile);
  if (chosen.size() < 2) return;
  std::vector<std::shared_ptr<const ImagePyramid>> pyramids;
  for (const std::size_t view : chosen) pyramids.push_back(sweep.images.get(sweep.views[view].image()));
  const int num_heights = 2 * sweep.num_steps + 1;
  CostVolume costs(tile.height, tile.width, num_heights);
  cv::Mat1b num_views;
  for (int d = 0; d < num_heights; ++d) {
    std::vector<Patch> patches;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      patches.push_back(lay_onto_surface(sweep, sweep.views[chosen[k]], *pyramids[k], tile, (d - sweep.num_steps) * sweep.step));
    }
    if (d == sweep.num_steps) num_views = count_views(patches, tile.size());
    const cv::Mat1f ncc = agreement(patches, tile.size(), sweep.options.window);
    for (int row = 0; row < tile.height; ++row) {
      for (int column = 0; column < tile.width; ++column) {
        costs.at(row, column)[d] = 1 - std::max(0.0F, ncc(row, column));
      }
    }
  }
  const CostVolume smooth =
      semi_global_sums(with_base_trust(sweep, costs, num_views), sweep.options.small_step_cost, sweep.options.large_step_cost);
  take_heights(sweep, costs, smooth, num_views, tile, kept, result);
}

/// Tiles no wider than half of what an image shows, so that the same views are good for all of one.
std::vector<cv::Rect> tiles_of(const Sweep& sweep) {
  const Camera& camera = sweep.views.front().camera();
  const int side = std::clamp(std::min(camera.width, camera.height) / 3 >> sweep.level, 16, 160);
  std::vector<cv::Rect> tiles;
  const GroundGrid& grid = sweep.base.grid;
  for (int row = 0; row < grid.rows; row += side) {
    for (int column = 0; column < grid.columns; column += side) {
      tiles.emplace_back(column, row, std::min(side, grid.columns - column), std::min(side, grid.rows - row));
    }
  }
  return tiles;
}

}  // namespace

HeightField plane_sweep(const HeightField& base, const std::vector<GroundView>& views, ImageCache& images, double range,
                        double step, int level, double flying_height, const PlaneSweepOptions& options) {
  const Sweep sweep{base, views, images,        std::max(1, static_cast<int>(std::lround(range / step))),
                    step, level, flying_height, options};
  HeightField result{base.grid, base.heights.clone(), cv::Mat1f(base.heights.size(), 0.0F)};
  const std::vector<cv::Rect> tiles = tiles_of(sweep);
  std::mutex mutex;
  std::size_t num_done = 0;
  parallel_for(tiles.size(), options.num_threads, [&](std::size_t i) {
    sweep_tile(sweep, tiles[i], result);
    const std::scoped_lock lock(mutex);
    if (options.progress) options.progress("surface, level " + std::to_string(level), ++num_done, tiles.size());
  });
  cv::Mat1f median;
  cv::medianBlur(result.heights, median, 5);
  const double agreeing = cv::countNonZero(result.confidence > 0);
  result.heights = agreeing > 0 ? fill_smoothly(median, result.confidence) : base.heights.clone();
  return result;
}

}  // namespace fabloop
