// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/seam_residual.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "frontend/parallel.h"
#include "posegraph/sfm/view_patch.h"

namespace fabloop {
namespace {

constexpr int kPatch = 64;

/// A place where the mosaic changes between two views that both show it.
struct Place {
  std::size_t block;
  std::size_t view_a, view_b;
};

bool shows(const MosaicBlocks& blocks, std::size_t block, std::int64_t view) {
  const auto seen = blocks.at(block);
  return std::any_of(seen.begin(), seen.end(),
                     [&](const BlockView& s) { return s.view == view && s.quality > 0.1F * seen[0].quality; });
}

std::vector<Place> seam_places(const MosaicScene& scene) {
  constexpr std::size_t kMaxPlaces = 600;
  std::vector<Place> places;
  const auto columns = static_cast<std::size_t>(scene.blocks.grid.columns);
  for (std::size_t p = 0; p + columns < scene.blocks.size(); ++p) {
    const std::size_t q = p % columns + 1 < columns ? p + 1 : p + columns;
    const auto shown = [&](std::size_t block) {
      return scene.shown(static_cast<int>(block / columns), static_cast<int>(block % columns)) != 0;
    };
    if (!shown(p) || !shown(q)) continue;
    const std::int64_t a = scene.seams.view_of(scene.blocks, p);
    const std::int64_t b = scene.seams.view_of(scene.blocks, q);
    if (a < 0 || b < 0 || a == b || !shows(scene.blocks, p, b) || !shows(scene.blocks, q, a)) continue;
    places.push_back({p, static_cast<std::size_t>(a), static_cast<std::size_t>(b)});
  }
  if (places.size() <= kMaxPlaces) return places;
  std::vector<Place> some;
  for (std::size_t k = 0; k < kMaxPlaces; ++k) some.push_back(places[k * places.size() / kMaxPlaces]);
  return some;
}

std::optional<double> displacement_at(const MosaicScene& scene, const Place& place) {
  const auto columns = static_cast<std::size_t>(scene.blocks.grid.columns);
  const int x = static_cast<int>(place.block % columns) * MosaicBlocks::kSide + MosaicBlocks::kSide / 2;
  const int y = static_cast<int>(place.block / columns) * MosaicBlocks::kSide + MosaicBlocks::kSide / 2;
  const cv::Rect part(x - kPatch / 2, y - kPatch / 2, kPatch, kPatch);
  if ((part & cv::Rect(0, 0, scene.grid.columns, scene.grid.rows)) != part) return std::nullopt;
  const cv::Mat1f heights = heights_of(scene.surface, scene.grid, part);
  cv::Mat grey[2];
  const std::size_t views[2] = {place.view_a, place.view_b};
  for (int k = 0; k < 2; ++k) {
    const GroundView& view = scene.views[views[k]];
    const auto pyramid = scene.images.get(view.image());
    const cv::Mat3f patch =
        lay_view(scene.grid, part, heights, view, *pyramid, scene.exposure, views[k], scene.camera_of[views[k]]);
    cv::cvtColor(patch, grey[k], cv::COLOR_BGR2GRAY);
    grey[k] -= cv::mean(grey[k]);
  }
  cv::Mat window;
  cv::createHanningWindow(window, part.size(), CV_32F);
  double response = 0;
  const cv::Point2d shift = cv::phaseCorrelate(grey[0], grey[1], window, &response);
  constexpr double kClearPeak = 0.2;  // below it the patches have too little in common to say
  if (!(response > kClearPeak)) return std::nullopt;
  return std::hypot(shift.x, shift.y);
}

}  // namespace

SeamResidual measure_seams(const MosaicScene& scene, int num_threads) {
  const std::vector<Place> places = seam_places(scene);
  std::vector<std::optional<double>> measured(places.size());
  parallel_for(places.size(), num_threads, [&](std::size_t i) { measured[i] = displacement_at(scene, places[i]); });
  std::vector<double> shifts;
  for (const auto& shift : measured) {
    if (shift) shifts.push_back(*shift);
  }
  SeamResidual residual;
  residual.num_places = shifts.size();
  if (shifts.empty()) return residual;
  std::sort(shifts.begin(), shifts.end());
  residual.median_px = shifts[shifts.size() / 2];
  residual.p90_px = shifts[shifts.size() * 9 / 10];
  return residual;
}

}  // namespace fabloop
