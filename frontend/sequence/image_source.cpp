// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/image_source.h"

#include <cmath>

#include "frontend/error.h"
#include "frontend/sequence/image_reader.h"
#include "frontend/sequence/stamped_images.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void validate(const ImageSourceOptions& options) {
  if (options.every == 0) throw InputError("every 0th image is none; give 1 or more");
  if (options.max_images_per_s && !(*options.max_images_per_s > 0.0 && std::isfinite(*options.max_images_per_s))) {
    throw InputError("the number of images a second must be positive");
  }
}

}  // namespace

ImageSource::ImageSource(const fs::path& path, const ImageSourceOptions& options) : name_(sequence_name(path)) {
  validate(options);
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    reader_ = make_video_reader(path, options);
  } else {
    reader_ = make_folder_reader(path, options);
  }
}

ImageSource::~ImageSource() = default;
ImageSource::ImageSource(ImageSource&&) noexcept = default;
ImageSource& ImageSource::operator=(ImageSource&&) noexcept = default;

std::vector<SourceImage> ImageSource::next(std::size_t max_images) { return reader_->next(max_images, damaged_frames_); }

std::optional<std::size_t> ImageSource::estimated_size() const { return reader_->estimated_size(); }

}  // namespace fabloop
