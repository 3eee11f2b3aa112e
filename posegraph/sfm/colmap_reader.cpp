// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "frontend/error.h"
#include "frontend/sequence/stamped_images.h"
#include "posegraph/sfm/colmap_camera.h"
#include "posegraph/sfm/colmap_io.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

using Id = std::int64_t;

/// The lines of a file that are no comments, with their numbers.
class Lines {
 public:
  explicit Lines(fs::path path) : path_(std::move(path)), in_(path_) {
    if (!in_)
      throw InputError(path_.string() + ": cannot be read; a COLMAP text model has cameras.txt, images.txt and points3D.txt");
  }

  /// The next line with anything on it.
  bool next(std::istringstream& line) {
    while (next_raw(line)) {
      if (!text_.empty()) return true;
    }
    return false;
  }

  /// The next line, which may be empty: that of an image without observations.
  bool next_raw(std::istringstream& line) {
    do {
      if (!std::getline(in_, text_)) return false;
      ++number_;
      if (!text_.empty() && text_.back() == '\r') text_.pop_back();
    } while (text_.starts_with('#'));
    line = std::istringstream(text_);
    return true;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_.string() + ":" + std::to_string(number_) + ": " + what);
  }

 private:
  fs::path path_;
  std::ifstream in_;
  std::string text_;
  int number_ = 0;
};

std::map<Id, std::size_t> read_cameras(const fs::path& path, Reconstruction& result) {
  Lines lines(path);
  std::istringstream line;
  std::map<Id, std::size_t> index;
  while (lines.next(line)) {
    Id id = 0;
    std::string model;
    int width = 0, height = 0;
    if (!(line >> id >> model >> width >> height)) lines.fail("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
    std::vector<double> parameters;
    for (double value = 0; line >> value;) parameters.push_back(value);
    if (!line.eof()) lines.fail("a parameter is no number");
    const auto camera = camera_from_colmap(model, width, height, parameters);
    if (!camera) {
      lines.fail("the camera model " + model + " with " + std::to_string(parameters.size()) +
                 " parameters is not known here; undistort the images with COLMAP or use OPENCV or OPENCV_FISHEYE");
    }
    validate(*camera, path.string() + ", camera " + std::to_string(id));
    if (!index.emplace(id, result.cameras.size()).second) lines.fail("camera " + std::to_string(id) + " stands there twice");
    result.cameras.push_back(*camera);
  }
  return index;
}

/// An image of the file before the images are put in order.
struct ReadImage {
  Id id = 0;
  PlacedImage placed;
  std::string name;
  std::vector<Eigen::Vector2d> pixels;  ///< All observations, with or without a point.
};

Pose world_from_colmap_pose(Lines& lines, std::istringstream& line) {
  double qw = 0, qx = 0, qy = 0, qz = 0;
  Pose camera_from_world;
  Eigen::Vector3d& t = camera_from_world.translation;
  if (!(line >> qw >> qx >> qy >> qz >> t.x() >> t.y() >> t.z()))
    lines.fail("expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
  camera_from_world.rotation = Eigen::Quaterniond(qw, qx, qy, qz);
  constexpr double kUnitLength = 1e-3;
  if (!(std::abs(camera_from_world.rotation.norm() - 1) < kUnitLength) || !t.allFinite()) {
    lines.fail("the quaternion (w first) is not of unit length, or the position is not finite");
  }
  camera_from_world.rotation.normalize();
  return camera_from_world.inverse();
}

std::vector<ReadImage> read_images(const fs::path& path, const std::map<Id, std::size_t>& cameras) {
  Lines lines(path);
  std::istringstream line;
  std::vector<ReadImage> images;
  while (lines.next(line)) {
    ReadImage image;
    if (!(line >> image.id)) lines.fail("expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    image.placed.world_from_camera = world_from_colmap_pose(lines, line);
    Id camera = 0;
    if (!(line >> camera) || !std::getline(line >> std::ws, image.name)) lines.fail("the camera id or the name is missing");
    const auto found = cameras.find(camera);
    if (found == cameras.end()) lines.fail("camera " + std::to_string(camera) + " is not in cameras.txt");
    image.placed.camera = found->second;
    if (lines.next_raw(line)) {
      double x = 0, y = 0;
      Id point = 0;
      while (line >> x >> y >> point) image.pixels.emplace_back(x - kColmapHalfPixel, y - kColmapHalfPixel);
      if (!line.eof()) lines.fail("expected triples X Y POINT3D_ID");
    }
    images.push_back(std::move(image));
  }
  return images;
}

/// Paths, frames and times: those of the folder where it has every image, else by order of ids.
void place_in_sequence(std::vector<ReadImage>& images, const fs::path& folder) {
  std::sort(images.begin(), images.end(), [](const ReadImage& a, const ReadImage& b) { return a.id < b.id; });
  std::map<fs::path, std::pair<std::size_t, std::int64_t>> known;
  if (!folder.empty()) {
    const std::vector<StampedPath> listed = list_stamped_images(folder);
    for (std::size_t i = 0; i < listed.size(); ++i) known[listed[i].path.lexically_normal()] = {i, listed[i].time_ns};
  }
  bool all_known = true;
  for (std::size_t i = 0; i < images.size(); ++i) {
    PlacedImage& placed = images[i].placed;
    const fs::path inside = folder / "images" / images[i].name;
    placed.image_path = !folder.empty() && fs::exists(inside) ? inside : folder / images[i].name;
    all_known = all_known && known.contains(placed.image_path.lexically_normal());
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    PlacedImage& placed = images[i].placed;
    constexpr std::int64_t kSecond = 1'000'000'000;
    const auto found =
        all_known ? known.at(placed.image_path.lexically_normal()) : std::pair(i, static_cast<std::int64_t>(i) * kSecond);
    placed.frame = found.first;
    placed.time_ns = found.second;
  }
  std::sort(images.begin(), images.end(), [](const ReadImage& a, const ReadImage& b) { return a.placed.frame < b.placed.frame; });
}

void read_points(const fs::path& path, const std::vector<ReadImage>& images, Reconstruction& result) {
  std::unordered_map<Id, std::size_t> index;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!index.emplace(images[i].id, i).second)
      throw InputError(path.string() + ": image " + std::to_string(images[i].id) + " stands twice in images.txt");
  }
  Lines lines(path);
  std::istringstream line;
  while (lines.next(line)) {
    Id id = 0;
    ScenePoint point;
    int r = 0, g = 0, b = 0;
    double error = 0;
    Eigen::Vector3d& x = point.x_in_world;
    if (!(line >> id >> x.x() >> x.y() >> x.z() >> r >> g >> b >> error))
      lines.fail("expected POINT3D_ID X Y Z R G B ERROR TRACK");
    point.red_green_blue = {static_cast<unsigned char>(r), static_cast<unsigned char>(g), static_cast<unsigned char>(b)};
    Id image = 0;
    std::size_t observation = 0;
    while (line >> image >> observation) {
      const auto found = index.find(image);
      if (found == index.end() || observation >= images[found->second].pixels.size()) {
        lines.fail("the track names image " + std::to_string(image) + ", observation " + std::to_string(observation) +
                   ", which images.txt does not have");
      }
      point.track.push_back({found->second, images[found->second].pixels[observation]});
    }
    if (!line.eof()) lines.fail("expected pairs IMAGE_ID POINT2D_IDX");
    std::stable_sort(point.track.begin(), point.track.end(),
                     [](const Sighting& a, const Sighting& c) { return a.image < c.image; });
    const auto same = [](const Sighting& a, const Sighting& c) { return a.image == c.image; };
    point.track.erase(std::unique(point.track.begin(), point.track.end(), same), point.track.end());
    result.points.push_back(std::move(point));
  }
}

}  // namespace

Reconstruction read_colmap_model(const fs::path& folder, const fs::path& images_folder) {
  Reconstruction result;
  const std::map<Id, std::size_t> cameras = read_cameras(folder / "cameras.txt", result);
  std::vector<ReadImage> images = read_images(folder / "images.txt", cameras);
  if (images.empty()) throw InputError((folder / "images.txt").string() + ": has no images");
  place_in_sequence(images, images_folder);
  read_points(folder / "points3D.txt", images, result);
  for (ReadImage& image : images) result.images.push_back(std::move(image.placed));
  return result;
}

}  // namespace fabloop
