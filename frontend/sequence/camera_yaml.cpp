// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/camera_yaml.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

#include "frontend/error.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// A YAML document and the file it stands in, for messages.
struct Document {
  fs::path path;
  YAML::Node root;

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what) const {
    const std::string line = mark.is_null() ? "" : ":" + std::to_string(mark.line + 1);
    throw InputError(path.string() + line + ": " + what);
  }
};

/// The text with OpenCV's `%YAML:1.0` head blanked, which is no valid YAML directive; lines keep their numbers.
std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || fs::is_directory(path) || !(text << file.rdbuf())) {
    throw InputError(path.string() + ": cannot be read as a calibration; does the file exist, and is it not empty?");
  }
  std::string result = text.str();
  if (result.starts_with("%YAML:")) result.erase(0, std::min(result.find('\n'), result.size()));
  return result;
}

YAML::Node first_of(const YAML::Node& node, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (const YAML::Node child = node[name]; child.IsDefined() && !child.IsNull()) return child;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

/// The numbers of a plain list, of a list of rows, or of a matrix with `data`.
std::vector<double> numbers(const Document& document, const YAML::Node& node, const std::string& name) {
  const YAML::Node data = node.IsMap() ? node["data"] : node;
  if (!data.IsDefined() || !data.IsSequence()) document.fail(node.Mark(), name + " is not a list of numbers");
  std::vector<double> values;
  for (const YAML::Node& item : data) {
    if (item.IsSequence()) {
      for (const YAML::Node& element : item) values.push_back(element.as<double>());
    } else {
      values.push_back(item.as<double>());
    }
  }
  return values;
}

void read_size(const Document& document, Camera& camera) {
  const YAML::Node width = first_of(document.root, {"image_width", "width"});
  const YAML::Node height = first_of(document.root, {"image_height", "height"});
  const YAML::Node resolution = first_of(document.root, {"resolution"});
  if (width.IsDefined() && height.IsDefined()) {
    camera.width = width.as<int>();
    camera.height = height.as<int>();
  } else if (resolution.IsDefined()) {
    const std::vector<double> size = numbers(document, resolution, "resolution");
    if (size.size() != 2) document.fail(resolution.Mark(), "resolution is not [width, height]");
    camera.width = static_cast<int>(size[0]);
    camera.height = static_cast<int>(size[1]);
  } else {
    document.fail(YAML::Mark::null_mark(), "has no image size; add image_width and image_height");
  }
}

void read_intrinsics(const Document& document, Camera& camera) {
  const YAML::Node matrix = first_of(document.root, {"camera_matrix", "cameraMatrix", "K", "k"});
  const YAML::Node intrinsics = first_of(document.root, {"intrinsics"});
  if (matrix.IsDefined()) {
    const std::vector<double> k = numbers(document, matrix, "the camera matrix");
    if (k.size() != 9) document.fail(matrix.Mark(), "the camera matrix has " + std::to_string(k.size()) + " numbers, not 9");
    camera.fx = k[0], camera.cx = k[2], camera.fy = k[4], camera.cy = k[5];
  } else if (intrinsics.IsDefined()) {
    const std::vector<double> f = numbers(document, intrinsics, "intrinsics");
    if (f.size() != 4) document.fail(intrinsics.Mark(), "intrinsics is not [fu, fv, pu, pv]; only pinhole cameras are known");
    camera.fx = f[0], camera.fy = f[1], camera.cx = f[2], camera.cy = f[3];
  } else {
    document.fail(YAML::Mark::null_mark(),
                  "has no camera_matrix (nor K, nor Kalibr's intrinsics); is it a camera calibration, such as ROS camera_info?");
  }
}

void read_distortion(const Document& document, Camera& camera) {
  if (const YAML::Node model = first_of(document.root, {"distortion_model"}); model.IsDefined()) {
    const auto name = model.as<std::string>();
    if (name == "equidistant" || name == "fisheye") {
      camera.distortion_model = DistortionModel::Equidistant;
    } else if (name != "plumb_bob" && name != "rational_polynomial" && name != "radtan" && name != "radial-tangential" &&
               name != "none" && !name.empty()) {
      document.fail(model.Mark(),
                    "distortion model '" + name + "' is not known; plumb_bob, rational_polynomial and equidistant are");
    }
  }
  const YAML::Node coefficients =
      first_of(document.root, {"distortion_coefficients", "distortion_coeffs", "distCoeffs", "dist_coeffs", "D", "d"});
  if (!coefficients.IsDefined()) return;
  camera.distortion = numbers(document, coefficients, "the distortion");
  // OpenCV pads to 12 or 14 with the thin-prism and tilt terms, which are zero unless asked for.
  constexpr std::size_t kMostCoefficients = 8;
  while (camera.distortion.size() > kMostCoefficients && camera.distortion.back() == 0) camera.distortion.pop_back();
}

}  // namespace

Camera read_camera_yaml(const fs::path& path) {
  const std::string text = read_text(path);
  Document document{path, {}};
  try {
    document.root = YAML::Load(text);
    if (!document.root.IsMap()) document.fail(YAML::Mark::null_mark(), "is not a calibration; expected ROS camera_info YAML");
    if (const YAML::Node camera = document.root["cam0"]; camera.IsDefined() && camera.IsMap()) document.root.reset(camera);
    Camera camera;
    read_size(document, camera);
    read_intrinsics(document, camera);
    read_distortion(document, camera);
    validate(camera, path.string());
    return camera;
  } catch (const YAML::Exception& error) {
    document.fail(error.mark, error.msg);
  }
}

}  // namespace fabloop
