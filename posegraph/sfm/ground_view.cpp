// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/ground_view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "frontend/error.h"
#include "posegraph/sfm/geodesy.h"

namespace fabloop {
namespace {

/// Least squares on what lies near, with the band narrowed to the residuals' spread: a few wild points do not tilt it.
Eigen::Vector3d plane_normal(std::vector<Eigen::Vector3d> points) {
  constexpr int kRounds = 10;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  std::vector<Eigen::Vector3d> kept = points;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : kept) mean += x / static_cast<double>(kept.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& x : kept) scatter += (x - mean) * (x - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    if (!(solver.eigenvalues()(1) > 1e-9 * solver.eigenvalues()(2))) {
      throw InputError(
          "the reconstruction's points lie on a line or in one place, so there is no ground plane; are there enough?");
    }
    normal = solver.eigenvectors().col(0);
    std::vector<double> distances;
    for (const Eigen::Vector3d& x : points) distances.push_back(std::abs(normal.dot(x - mean)));
    std::vector<double> sorted = distances;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    constexpr double kBand = 3 * 1.4826;  // three standard deviations of normal noise, from the median
    kept.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (distances[i] <= kBand * *middle) kept.push_back(points[i]);
    }
  }
  return normal;
}

Eigen::Vector3d mean_plane_up(const Reconstruction& reconstruction) {
  std::vector<Eigen::Vector3d> points;
  for (const ScenePoint& point : reconstruction.points) points.push_back(point.x_in_world);
  if (points.size() < 3) throw InputError("the reconstruction has fewer than 3 points, so there is no ground plane");
  const Eigen::Vector3d normal = plane_normal(points);
  // Cameras look down: their optical axes point away from the side they are on.
  double towards = 0;
  for (const PlacedImage& image : reconstruction.images) {
    towards += (image.world_from_camera.rotation * Eigen::Vector3d::UnitZ()).dot(normal);
  }
  return towards > 0 ? Eigen::Vector3d(-normal) : normal;
}

double max_slope_of(const Camera& camera) {
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  double largest = 0;
  for (const Eigen::Vector3d& ray : bearings(camera, {{-0.5, -0.5}, {right, -0.5}, {-0.5, bottom}, {right, bottom}})) {
    largest = std::max(largest, ray.head<2>().norm() / std::max(ray.z(), 1e-6));
  }
  return largest;
}

}  // namespace

Pose ground_from_world(const Reconstruction& reconstruction, UpDirection up) {
  Pose result;
  if (up == UpDirection::Automatic) up = reconstruction.origin ? UpDirection::WorldZ : UpDirection::MeanPlane;
  if (up == UpDirection::MeanPlane) {
    result.rotation = Eigen::Quaterniond::FromTwoVectors(mean_plane_up(reconstruction), Eigen::Vector3d::UnitZ());
  }
  if (reconstruction.origin) {
    const double convergence = rad_from_deg(map_grid_at(*reconstruction.origin).convergence_deg);
    result.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(convergence, Eigen::Vector3d::UnitZ())) * result.rotation;
  }
  return result;
}

GroundView::GroundView(std::size_t image, const Camera& camera, const Pose& ground_from_camera)
    : image_(image),
      camera_(camera),
      ground_from_camera_(ground_from_camera),
      camera_from_ground_(ground_from_camera.inverse()),
      max_slope_(max_slope_of(camera)) {}

std::optional<Eigen::Vector2d> GroundView::project(const Eigen::Vector3d& x_in_ground) const {
  const Eigen::Vector3d x = camera_from_ground_ * x_in_ground;
  // Distortion polynomials fold back far outside the image they were fitted to.
  constexpr double kTrusted = 1.1;
  if (!(x.z() > 0) || x.head<2>().norm() > kTrusted * max_slope_ * x.z()) return std::nullopt;
  return fabloop::project(camera_, x);
}

std::optional<Eigen::Vector2d> GroundView::pixel_of(const Eigen::Vector3d& x_in_ground) const {
  const auto pixel = project(x_in_ground);
  if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera_.width - 1 || pixel->y() > camera_.height - 1) return {};
  return pixel;
}

double GroundView::quality(const Eigen::Vector3d& x_in_ground, const Eigen::Vector2d& pixel, double height) const {
  const Eigen::Vector3d way = centre() - x_in_ground;
  const double distance = way.norm();
  const double from_above = std::max(0.0, way.z() / distance);
  const double nearness = std::min(1.0, height / distance);
  const double border = std::min({pixel.x(), pixel.y(), camera_.width - 1 - pixel.x(), camera_.height - 1 - pixel.y()});
  constexpr double kBorderPart = 0.12;
  const double inside = std::clamp(border / (kBorderPart * std::min(camera_.width, camera_.height)), 0.0, 1.0);
  return from_above * from_above * nearness * (0.05 + 0.95 * inside);
}

std::vector<GroundView> ground_views(const Reconstruction& reconstruction, const Pose& ground_from_world) {
  std::vector<GroundView> views;
  views.reserve(reconstruction.images.size());
  for (std::size_t i = 0; i < reconstruction.images.size(); ++i) {
    const PlacedImage& image = reconstruction.images[i];
    views.emplace_back(i, reconstruction.cameras[image.camera], ground_from_world * image.world_from_camera);
  }
  return views;
}

}  // namespace fabloop
