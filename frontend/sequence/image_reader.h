// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frontend/sequence/image_source.h"

namespace fabloop {

/// Which images are wanted of those that come in order of time.
class ImageSelection {
 public:
  explicit ImageSelection(const ImageSourceOptions& options)
      : every_(options.every), interval_ns_(options.max_images_per_s ? 1e9 / *options.max_images_per_s : 0.0) {}

  bool takes(std::size_t frame, std::int64_t time_ns) {
    if (frame % every_ != 0) return false;
    if (interval_ns_ == 0.0) return true;
    const auto time = static_cast<double>(time_ns);
    if (!due_ns_) due_ns_ = time;
    // Stamps are rounded, and a frame must not miss its turn by that.
    constexpr double kToleranceNs = 1e6;
    if (time + kToleranceNs < *due_ns_) return false;
    // From the turn, not from the frame, so that the rate is kept; after a gap from the frame, so that it is not made up for.
    *due_ns_ = std::max(*due_ns_ + interval_ns_, time);
    return true;
  }

 private:
  std::size_t every_;
  double interval_ns_;
  std::optional<double> due_ns_;
};

/// What folders and videos have in common.
class ImageReader {
 public:
  explicit ImageReader(const ImageSourceOptions& options) : options_(options), selection_(options) {}
  virtual ~ImageReader() = default;
  ImageReader(const ImageReader&) = delete;
  ImageReader& operator=(const ImageReader&) = delete;

  /// As ImageSource::next; frames that cannot be read are added to `damaged_frames`.
  virtual std::vector<SourceImage> next(std::size_t max_images, std::vector<std::size_t>& damaged_frames) = 0;
  virtual std::optional<std::size_t> estimated_size() const = 0;

 protected:
  void warn(const std::string& message) const {
    if (options_.warn) options_.warn(message);
  }

  ImageSourceOptions options_;
  ImageSelection selection_;
};

/// Reads a folder of images; see ImageSource.
std::unique_ptr<ImageReader> make_folder_reader(const std::filesystem::path& folder, const ImageSourceOptions& options);

/// Reads a video; see ImageSource.
std::unique_ptr<ImageReader> make_video_reader(const std::filesystem::path& video, const ImageSourceOptions& options);

}  // namespace fabloop
