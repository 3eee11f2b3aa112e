// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frontend/progress.h"
#include "frontend/sequence/if_damaged.h"

namespace fabloop {

/// An image and when it was taken.
struct SourceImage {
  std::size_t frame = 0;  ///< Its 0-based position in the folder or video, whether or not others were left out.
  std::int64_t time_ns = 0;
  cv::Mat gray;    ///< CV_8UC1.
  cv::Mat colour;  ///< CV_8UC3 (blue, green, red), of a video when `keep_colour` asks for it; the images of a folder have files.
};

struct ImageSourceOptions {
  std::size_t every = 1;  ///< Only every Nth image, from the first. More where neighbours show nearly the same.
  /// Only so many images a second of the source's own time, each the first that is due. None: all.
  std::optional<double> max_images_per_s{};
  bool keep_colour = false;  ///< Of videos.
  IfDamaged if_damaged = IfDamaged::Skip;
  int num_threads = 0;  ///< 0: all. For the decoding of image files; a video is decoded by one.
  Warn warn{};          ///< Told about images that are skipped and about a video that ends early.
};

class ImageReader;

/// Images one after the other, from a folder of images or a video. Appearance needs no calibration, so none is read. Memory is
/// that of the images asked for at a time.
class ImageSource {
 public:
  /// `path` is a folder as for list_stamped_images, or a video that OpenCV can decode (avi, mp4, mkv, mov, ...). Throws
  /// InputError: nothing there, no images, no video, a bad option.
  explicit ImageSource(const std::filesystem::path& path, const ImageSourceOptions& options = {});
  ~ImageSource();
  ImageSource(ImageSource&&) noexcept;
  ImageSource& operator=(ImageSource&&) noexcept;

  /// The next `max_images` at most; none at the end, and only there. Images that cannot be read are left out, or, under
  /// `Refuse`, InputError is thrown, also for a video that ends before its container says.
  std::vector<SourceImage> next(std::size_t max_images);

  /// How many images there are at most; for videos what the container says, which may be wrong. None where it says nothing.
  std::optional<std::size_t> estimated_size() const;

  const std::string& name() const { return name_; }

  /// Frames left out so far because they could not be read.
  const std::vector<std::size_t>& damaged_frames() const { return damaged_frames_; }

 private:
  std::string name_;
  std::unique_ptr<ImageReader> reader_;
  std::vector<std::size_t> damaged_frames_;
};

}  // namespace fabloop
