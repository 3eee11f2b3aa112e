// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "frontend/error.h"
#include "frontend/sequence/image_completeness.h"
#include "frontend/sequence/sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read_bytes(const fs::path& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::is_directory(path, error))
    throw InputError(path.string() + ": the image cannot be read; does the file exist?");
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty()) throw InputError(path.string() + ": the image file is empty; copy it again");
  return bytes;
}

cv::Mat decode_gray(const std::vector<std::uint8_t>& bytes) {
  try {
    // A calibration speaks of the sensor's pixels, so the EXIF orientation must not turn the image.
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

cv::Mat read_gray_image(const fs::path& image_path) {
  const std::vector<std::uint8_t> bytes = read_bytes(image_path);
  if (!is_complete_image(bytes)) throw InputError(image_path.string() + ": the image is truncated; copy it again or remove it");
  const cv::Mat gray = decode_gray(bytes);
  if (gray.empty())
    throw InputError(image_path.string() + ": the image is damaged or of an unknown kind; copy it again or remove it");
  return gray;
}

cv::Mat read_gray_image(const fs::path& image_path, const Camera& camera) {
  cv::Mat gray = read_gray_image(image_path);
  if (gray.cols != camera.width || gray.rows != camera.height) {
    throw InputError(image_path.string() + ": the image is " + size_text(gray.cols, gray.rows) +
                     " pixels, but the calibration is for " + size_text(camera.width, camera.height) +
                     "; calibrate at the images' size, or scale fx, fy, cx, cy with it");
  }
  return gray;
}

}  // namespace fabloop
