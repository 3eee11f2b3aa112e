// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/view_patch.h"

#include <opencv2/imgproc.hpp>

#include "posegraph/sfm/mosaic_blocks.h"

namespace fabloop {

cv::Mat1f heights_of(const HeightField& surface, const GroundGrid& grid, const cv::Rect& part) {
  cv::Mat1f heights(part.size());
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      heights(row, column) = static_cast<float>(height_at(surface, grid.ground_at(part.x + column, part.y + row)));
    }
  }
  return heights;
}

cv::Mat3f lay_view(const GroundGrid& grid, const cv::Rect& part, const cv::Mat1f& heights, const GroundView& view,
                   const ImagePyramid& pyramid, const Exposure& exposure, std::size_t index, std::size_t camera) {
  const Eigen::Vector2d middle = grid.ground_at(part.x + 0.5 * part.width, part.y + 0.5 * part.height);
  const double distance =
      (view.centre() - Eigen::Vector3d(middle.x(), middle.y(), heights(part.height / 2, part.width / 2))).norm();
  const int level = pyramid_level(grid.spacing, distance / view.camera().focal_px());
  cv::Mat1f map_x(part.size()), map_y(part.size()), radius(part.size(), 0.0F);
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      const Eigen::Vector2d x = grid.ground_at(part.x + column, part.y + row);
      const auto pixel = view.project({x.x(), x.y(), heights(row, column)});
      const Eigen::Vector2d at = pixel ? pyramid.on_level(*pixel, level) : Eigen::Vector2d(-1, -1);
      map_x(row, column) = static_cast<float>(at.x());
      map_y(row, column) = static_cast<float>(at.y());
      if (pixel) radius(row, column) = static_cast<float>(std::min(1.0, image_radius(view.camera(), *pixel)));
    }
  }
  cv::Mat3b as_taken;
  cv::remap(pyramid.colour[level], as_taken, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  cv::Mat3f patch(part.size());
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      patch(row, column) = cv::Vec3f(as_taken(row, column)).mul(exposure.gain(index, camera, radius(row, column)));
    }
  }
  return patch;
}

}  // namespace fabloop
