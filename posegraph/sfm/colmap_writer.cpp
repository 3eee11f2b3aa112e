// SPDX-License-Identifier: BSD-3-Clause
#include <iomanip>
#include <limits>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/sfm/colmap_camera.h"
#include "posegraph/sfm/colmap_io.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Enough digits to read back the same bits.
void set_exact(std::ostream& out) { out << std::setprecision(std::numeric_limits<double>::max_digits10); }

fs::path common_folder(const std::vector<PlacedImage>& images) {
  if (images.empty()) return {};
  fs::path common = images.front().image_path.parent_path();
  for (const PlacedImage& image : images) {
    const fs::path folder = image.image_path.parent_path();
    fs::path shared;
    auto a = common.begin();
    for (auto b = folder.begin(); a != common.end() && b != folder.end() && *a == *b; ++a, ++b) shared /= *a;
    common = shared;
  }
  return common;
}

void write_cameras(const fs::path& path, const Reconstruction& reconstruction) {
  OutputFile file(path);
  set_exact(file.stream());
  file.stream() << "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (std::size_t i = 0; i < reconstruction.cameras.size(); ++i) {
    const ColmapCamera camera = colmap_from_camera(reconstruction.cameras[i]);
    file.stream() << i + 1 << ' ' << camera.model << ' ' << reconstruction.cameras[i].width << ' '
                  << reconstruction.cameras[i].height;
    for (const double parameter : camera.parameters) file.stream() << ' ' << parameter;
    file.stream() << '\n';
  }
  file.commit();
}

/// What one image shows.
struct Observation2d {
  Eigen::Vector2d pixel;
  std::size_t point;
};

void write_images(const fs::path& path, const Reconstruction& reconstruction,
                  const std::vector<std::vector<Observation2d>>& shown) {
  const fs::path base = common_folder(reconstruction.images);
  OutputFile file(path);
  std::ostream& out = file.stream();
  set_exact(out);
  out << "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME (camera_from_world)\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (std::size_t i = 0; i < reconstruction.images.size(); ++i) {
    const PlacedImage& image = reconstruction.images[i];
    const Pose camera_from_world = image.world_from_camera.inverse();
    const Eigen::Quaterniond& q = camera_from_world.rotation;
    const Eigen::Vector3d& t = camera_from_world.translation;
    const std::string name = image.image_path.lexically_relative(base).generic_string();
    out << i + 1 << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << t.x() << ' ' << t.y() << ' ' << t.z()
        << ' ' << image.camera + 1 << ' ' << (base.empty() ? image.image_path.generic_string() : name) << '\n';
    for (std::size_t k = 0; k < shown[i].size(); ++k) {
      const Eigen::Vector2d& pixel = shown[i][k].pixel;
      out << (k > 0 ? " " : "") << pixel.x() + kColmapHalfPixel << ' ' << pixel.y() + kColmapHalfPixel << ' '
          << shown[i][k].point + 1;
    }
    out << '\n';
  }
  file.commit();
}

/// Mean distance between where a point was seen and where it projects to [px]; 0 where nobody sees it.
double mean_error_px(const Reconstruction& reconstruction, const ScenePoint& point) {
  double sum = 0;
  std::size_t count = 0;
  for (const Sighting& sighting : point.track) {
    const PlacedImage& image = reconstruction.images[sighting.image];
    const auto pixel =
        project(reconstruction.cameras[image.camera], pose_at_sighting(reconstruction, sighting).inverse() * point.x_in_world);
    if (!pixel) continue;
    sum += (*pixel - sighting.pixel).norm();
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

void write_points(const fs::path& path, const Reconstruction& reconstruction,
                  const std::vector<std::vector<std::size_t>>& index_in_image) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  set_exact(out);
  out << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (std::size_t p = 0; p < reconstruction.points.size(); ++p) {
    const ScenePoint& point = reconstruction.points[p];
    const Eigen::Vector3d& x = point.x_in_world;
    const cv::Vec3b& rgb = point.red_green_blue;
    out << p + 1 << ' ' << x.x() << ' ' << x.y() << ' ' << x.z() << ' ' << int{rgb[0]} << ' ' << int{rgb[1]} << ' ' << int{rgb[2]}
        << ' ' << mean_error_px(reconstruction, point);
    for (std::size_t k = 0; k < point.track.size(); ++k) out << ' ' << point.track[k].image + 1 << ' ' << index_in_image[p][k];
    out << '\n';
  }
  file.commit();
}

}  // namespace

void write_colmap_model(const fs::path& folder, const Reconstruction& reconstruction) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be created (" + error.message() + "); choose another place");
  std::vector<std::vector<Observation2d>> shown(reconstruction.images.size());
  std::vector<std::vector<std::size_t>> index_in_image(reconstruction.points.size());
  for (std::size_t p = 0; p < reconstruction.points.size(); ++p) {
    for (const Sighting& sighting : reconstruction.points[p].track) {
      index_in_image[p].push_back(shown[sighting.image].size());
      shown[sighting.image].push_back({sighting.pixel, p});
    }
  }
  write_cameras(folder / "cameras.txt", reconstruction);
  write_images(folder / "images.txt", reconstruction, shown);
  write_points(folder / "points3D.txt", reconstruction, index_in_image);
}

}  // namespace fabloop
