// SPDX-License-Identifier: BSD-3-Clause
#include "data/sequence_files.h"

#include <iomanip>
#include <opencv2/imgcodecs.hpp>

#include "frontend/error.h"
#include "frontend/output_file.h"

namespace fabloop {

void write_camera_yaml(const std::filesystem::path& path, const Camera& camera) {
  if (camera.distortion_model != DistortionModel::Radtan || camera.distortion.size() > 5) {
    throw InputError(path.string() + ": only cameras with a plumb-bob lens are written");
  }
  std::vector<double> k = camera.distortion;
  k.resize(5, 0.0);
  OutputFile file(path);
  auto& out = file.stream();
  out << std::setprecision(10) << "image_width: " << camera.width << "\nimage_height: " << camera.height
      << "\ncamera_name: fabloop\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [" << camera.fx << ", 0, " << camera.cx << ", 0, "
      << camera.fy << ", " << camera.cy
      << ", 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n"
      << "  data: [" << k[0] << ", " << k[1] << ", " << k[2] << ", " << k[3] << ", " << k[4] << "]\n"
      << "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n  rows: 3\n  "
         "cols: 4\n"
      << "  data: [" << camera.fx << ", 0, " << camera.cx << ", 0, 0, " << camera.fy << ", " << camera.cy << ", 0, 0, 0, 1, 0]\n";
  file.commit();
}

void write_image(const std::filesystem::path& path, const cv::Mat& image, const std::vector<int>& parameters) {
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, parameters);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw InputError(path.string() + ": could not be written; is the disk full?");
}

}  // namespace fabloop
