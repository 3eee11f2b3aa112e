// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruction_picture.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kLongSide = 1400;
constexpr int kBorderPx = 40;

/// Rows: right, up of the picture, and towards the viewer, in the world.
Eigen::Matrix3d picture_axes(const Reconstruction& map) {
  if (map.origin) return Eigen::Matrix3d::Identity();  // east, north, up
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PlacedImage& image : map.images) {
    view += image.world_from_camera.rotation * Eigen::Vector3d::UnitZ();
    mean += image.world_from_camera.translation / static_cast<double>(map.images.size());
  }
  if (view.norm() < 1e-9) view = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up = -view.normalized();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PlacedImage& image : map.images) {
    Eigen::Vector3d offset = image.world_from_camera.translation - mean;
    offset -= up * up.dot(offset);
    scatter += offset * offset.transpose();
  }
  // The path's longest axis lies across the picture.
  Eigen::Vector3d right = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(2);
  right = (right - up * up.dot(right)).normalized();
  Eigen::Matrix3d axes;
  axes << right.transpose(), up.cross(right).transpose(), up.transpose();
  return axes;
}

/// Where the world lands on the picture.
class FromAbove {
 public:
  explicit FromAbove(const Reconstruction& map) : axes_(picture_axes(map)) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low;
    for (const PlacedImage& image : map.images) include(image.world_from_camera.translation, low, high);
    // Far points at a horizon would leave the rest a speck: the middle 98 % count.
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> values;
      for (const ScenePoint& point : map.points) values.push_back((axes_ * point.x_in_world)(axis));
      if (values.empty()) continue;
      std::sort(values.begin(), values.end());
      low(axis) = std::min(low(axis), values[values.size() / 100]);
      high(axis) = std::max(high(axis), values[values.size() - 1 - values.size() / 100]);
    }
    const Eigen::Vector2d extent = (high - low).cwiseMax(1e-9);
    px_per_unit_ = (kLongSide - 2 * kBorderPx) / extent.maxCoeff();
    low_ = low;
    height_ = static_cast<int>(std::ceil(extent.y() * px_per_unit_)) + 2 * kBorderPx;
    width_ = static_cast<int>(std::ceil(extent.x() * px_per_unit_)) + 2 * kBorderPx;
  }

  cv::Size size() const { return {width_, height_}; }
  double px_per_unit() const { return px_per_unit_; }
  double towards_viewer(const Eigen::Vector3d& x_in_world) const { return axes_.row(2).dot(x_in_world); }

  cv::Point2d operator()(const Eigen::Vector3d& x_in_world) const {
    const Eigen::Vector2d x = ((axes_ * x_in_world).head<2>() - low_) * px_per_unit_;
    return {kBorderPx + x.x(), height_ - kBorderPx - x.y()};
  }

 private:
  void include(const Eigen::Vector3d& x_in_world, Eigen::Vector2d& low, Eigen::Vector2d& high) const {
    const Eigen::Vector2d x = (axes_ * x_in_world).head<2>();
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }

  Eigen::Matrix3d axes_;
  Eigen::Vector2d low_;
  double px_per_unit_ = 1;
  int width_ = 0, height_ = 0;
};

void draw_points(cv::Mat& picture, const FromAbove& from_above, const Reconstruction& map) {
  std::vector<const ScenePoint*> order;
  for (const ScenePoint& point : map.points) order.push_back(&point);
  // High ones hide low ones.
  std::stable_sort(order.begin(), order.end(), [&](const ScenePoint* a, const ScenePoint* b) {
    return from_above.towards_viewer(a->x_in_world) < from_above.towards_viewer(b->x_in_world);
  });
  for (const ScenePoint* point : order) {
    const cv::Point2d at = from_above(point->x_in_world);
    const cv::Vec3b& colour = point->red_green_blue;
    const cv::Rect spot(static_cast<int>(std::lround(at.x)) - 1, static_cast<int>(std::lround(at.y)) - 1, 3, 3);
    const cv::Rect visible = spot & cv::Rect({0, 0}, picture.size());
    if (visible.area() > 0) picture(visible) = cv::Scalar(colour[2], colour[1], colour[0]);
  }
}

}  // namespace

cv::Mat draw_reconstruction(const Reconstruction& map, const std::vector<std::pair<std::size_t, std::size_t>>& loops) {
  const FromAbove from_above(map);
  cv::Mat picture(from_above.size(), CV_8UC3, plot::kPaper);
  draw_points(picture, from_above, map);
  const cv::Scalar green(80, 220, 80);
  const cv::Scalar blue(230, 90, 20);
  const auto centre = [&](std::size_t image) { return from_above(map.images[image].world_from_camera.translation); };
  for (const auto& [query, match] : loops) draw::line(picture, centre(query), centre(match), green, 1);
  for (std::size_t i = 1; i < map.images.size(); ++i) draw::line(picture, centre(i - 1), centre(i), blue, 2);
  if (map.unit == LengthUnit::Metres) {
    plot::draw_scale_bar(picture, cv::Point2d(picture.cols - kBorderPx, picture.rows - 15), from_above.px_per_unit(),
                         0.2 * picture.cols, "m");
  }
  return picture;
}

}  // namespace fabloop
