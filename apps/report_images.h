// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fabloop::apps {

/// Small pictures of a run's images.
struct Thumbnails {
  int image_width = 0, image_height = 0;  ///< Of the images themselves, px; 0 where none could be read.
  std::vector<std::string> jpegs;         ///< One an image, as files; empty where an image could not be read.
};

struct ThumbnailOptions {
  std::size_t max_bytes = 5'000'000;  ///< Of all of them: the page's budget. They are the smaller the more there are.
  int max_width_px = 640;
  int jpeg_quality = 60;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
};

/// Reads the images and makes them small.
Thumbnails make_thumbnails(const std::vector<std::filesystem::path>& images, const ThumbnailOptions& options = {});

/// Bytes as text: RFC 4648, section 4.
std::string base64(const std::string& bytes);

}  // namespace fabloop::apps
