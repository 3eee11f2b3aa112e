// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"
#include "frontend/sequence/image_reader.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/stamped_images.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

class FolderReader : public ImageReader {
 public:
  FolderReader(const fs::path& folder, const ImageSourceOptions& options) : ImageReader(options), folder_(folder) {
    const std::vector<StampedPath> images = list_stamped_images(folder, options.warn);
    for (std::size_t frame = 0; frame < images.size(); ++frame) {
      if (selection_.takes(frame, images[frame].time_ns)) wanted_.push_back({frame, images[frame]});
    }
  }

  std::vector<SourceImage> next(std::size_t max_images, std::vector<std::size_t>& damaged_frames) override {
    std::vector<SourceImage> images;
    while (images.empty() && position_ < wanted_.size()) images = next_block(max_images, damaged_frames);
    if (images.empty() && damaged_frames.size() == wanted_.size()) {
      throw InputError(folder_.string() + ": none of its " + std::to_string(wanted_.size()) +
                       " images can be read, the first is " + wanted_.front().image.path.filename().string() +
                       "; copy them again");
    }
    return images;
  }

  std::optional<std::size_t> estimated_size() const override { return wanted_.size(); }

 private:
  struct Wanted {
    std::size_t frame;
    StampedPath image;
  };

  std::vector<SourceImage> next_block(std::size_t max_images, std::vector<std::size_t>& damaged_frames) {
    const std::size_t count = std::min(max_images, wanted_.size() - position_);
    std::vector<SourceImage> block(count);
    std::vector<std::string> problems(count);
    parallel_for(count, options_.num_threads, [&](std::size_t i) {
      const Wanted& wanted = wanted_[position_ + i];
      block[i] = {wanted.frame, wanted.image.time_ns, {}, {}};
      try {
        block[i].gray = read_gray_image(wanted.image.path);
      } catch (const InputError& error) {
        if (options_.if_damaged == IfDamaged::Refuse) throw;
        problems[i] = error.what();
      }
    });
    position_ += count;
    std::vector<SourceImage> images;
    for (std::size_t i = 0; i < count; ++i) {
      if (!block[i].gray.empty()) {
        images.push_back(std::move(block[i]));
      } else {
        damaged_frames.push_back(block[i].frame);
        warn(problems[i] + " (skipped)");
      }
    }
    return images;
  }

  fs::path folder_;
  std::vector<Wanted> wanted_;
  std::size_t position_ = 0;
};

}  // namespace

std::unique_ptr<ImageReader> make_folder_reader(const fs::path& folder, const ImageSourceOptions& options) {
  return std::make_unique<FolderReader>(folder, options);
}

}  // namespace fabloop
