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

cv::Mat decode(const std::vector<std::uint8_t>& bytes, cv::ImreadModes mode) {
  try {
    // A calibration speaks of the sensor's pixels, so the EXIF orientation must not turn the image.
    return cv::imdecode(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

cv::Mat read_image(const fs::path& image_path, cv::ImreadModes mode) {
  const std::vector<std::uint8_t> bytes = read_bytes(image_path);
  if (!is_complete_image(bytes)) throw InputError(image_path.string() + ": the image is truncated; copy it again or remove it");
  const cv::Mat image = decode(bytes, mode);
  if (image.empty())
    throw InputError(image_path.string() + ": the image is damaged or of an unknown kind; copy it again or remove it");
  return image;
}

void require_size(const fs::path& image_path, const cv::Mat& image, const Camera& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw InputError(image_path.string() + ": the image is " + size_text(image.cols, image.rows) +
                   " pixels, but the calibration is for " + size_text(camera.width, camera.height) +
                   "; calibrate at the images' size, or scale fx, fy, cx, cy with it");
}

}  // namespace

cv::Mat read_gray_image(const fs::path& image_path) { return read_image(image_path, cv::IMREAD_GRAYSCALE); }

cv::Mat read_gray_image(const fs::path& image_path, const Camera& camera) {
  cv::Mat gray = read_gray_image(image_path);
  require_size(image_path, gray, camera);
  return gray;
}

cv::Mat read_colour_image(const fs::path& image_path, const Camera& camera) {
  cv::Mat colour = read_image(image_path, cv::IMREAD_COLOR);
  require_size(image_path, colour, camera);
  return colour;
}

}  // namespace fabloop
