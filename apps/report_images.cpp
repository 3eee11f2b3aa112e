// SPDX-License-Identifier: BSD-3-Clause
#include "apps/report_images.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "frontend/parallel.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

/// Decodes at a reduced size where that is still large enough, which saves most of the time.
cv::Mat read_reduced(const fs::path& path, int full_width, int wanted_width) {
  int flags = cv::IMREAD_COLOR;
  if (full_width >= 8 * wanted_width) {
    flags = cv::IMREAD_REDUCED_COLOR_8;
  } else if (full_width >= 4 * wanted_width) {
    flags = cv::IMREAD_REDUCED_COLOR_4;
  } else if (full_width >= 2 * wanted_width) {
    flags = cv::IMREAD_REDUCED_COLOR_2;
  }
  // The pixels as they lie in the file, as everything else here counts them.
  return cv::imread(path.string(), flags | cv::IMREAD_IGNORE_ORIENTATION);
}

std::string encode(const cv::Mat& image, int width, int quality) {
  if (image.empty()) return "";
  const int height = std::max(1, static_cast<int>(std::lround(static_cast<double>(image.rows) * width / image.cols)));
  cv::Mat small;
  cv::resize(image, small, {width, height}, 0, 0, cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
  return {bytes.begin(), bytes.end()};
}

/// Width at which textured ground takes about so many bytes.
int first_width(std::size_t bytes_an_image, const ThumbnailOptions& options) {
  constexpr double kBytesAPixel = 0.2;
  constexpr double kAspect = 0.75;
  constexpr int kLeastWidth = 64;
  const double width = std::sqrt(static_cast<double>(bytes_an_image) / (kBytesAPixel * kAspect));
  return std::clamp(static_cast<int>(width), kLeastWidth, options.max_width_px);
}

}  // namespace

Thumbnails make_thumbnails(const std::vector<fs::path>& images, const ThumbnailOptions& options) {
  Thumbnails result;
  for (const fs::path& path : images) {
    const cv::Mat image = cv::imread(path.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    if (image.empty()) continue;
    result.image_width = image.cols;
    result.image_height = image.rows;
    break;
  }
  result.jpegs.resize(images.size());
  if (result.image_width == 0) return result;
  int width = std::min(first_width(options.max_bytes / images.size(), options), result.image_width);
  constexpr int kMaxAttempts = 4;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    parallel_for(images.size(), options.num_threads, [&](std::size_t i) {
      result.jpegs[i] = encode(read_reduced(images[i], result.image_width, width), width, options.jpeg_quality);
    });
    std::size_t num_bytes = 0;
    for (const std::string& jpeg : result.jpegs) num_bytes += jpeg.size();
    if (num_bytes <= options.max_bytes) return result;
    constexpr double kMargin = 0.95;
    width = std::max(16, static_cast<int>(kMargin * width *
                                          std::sqrt(static_cast<double>(options.max_bytes) / static_cast<double>(num_bytes))));
  }
  return result;
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0U;
    };
    const std::uint32_t group = at(0) << 16 | at(1) << 8 | at(2);
    text += kDigits[group >> 18];
    text += kDigits[group >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[group >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[group & 63] : '=';
  }
  return text;
}

}  // namespace fabloop::apps
