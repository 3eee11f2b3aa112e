// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/image_source.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"
#include "frontend/sequence/image_folder.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/stamped_images.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Which images are wanted of those that come in order of time.
class Selection {
 public:
  explicit Selection(const ImageSourceOptions& options)
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

void validate(const ImageSourceOptions& options) {
  if (options.every == 0) throw InputError("every 0th image is none; give 1 or more");
  if (options.max_images_per_s && !(*options.max_images_per_s > 0.0 && std::isfinite(*options.max_images_per_s))) {
    throw InputError("the number of images a second must be positive");
  }
}

}  // namespace

/// What folders and videos have in common.
class ImageSource::Reader {
 public:
  explicit Reader(const ImageSourceOptions& options) : options_(options), selection_(options) {}
  virtual ~Reader() = default;

  virtual std::vector<SourceImage> next(std::size_t max_images, std::vector<std::size_t>& damaged_frames) = 0;
  virtual std::optional<std::size_t> estimated_size() const = 0;

 protected:
  void warn(const std::string& message) const {
    if (options_.warn) options_.warn(message);
  }

  ImageSourceOptions options_;
  Selection selection_;
};

class ImageSource::FolderReader : public ImageSource::Reader {
 public:
  FolderReader(const fs::path& folder, const ImageSourceOptions& options) : Reader(options), folder_(folder) {
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
      block[i] = {wanted.frame, wanted.image.time_ns, {}};
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

class ImageSource::VideoReader : public ImageSource::Reader {
 public:
  VideoReader(const fs::path& path, const ImageSourceOptions& options) : Reader(options), path_(path) {
    if (is_image_file(path)) {
      throw InputError(path.string() + ": is one image; give the folder that holds the images, or a video");
    }
    if (!open() || !video_.grab()) {
      throw InputError(path.string() +
                       ": is no video that can be decoded (avi, mp4, mkv, mov, ...); convert it, or copy it again");
    }
    has_grabbed_ = true;
    fps_ = video_.get(cv::CAP_PROP_FPS);
    const double count = video_.get(cv::CAP_PROP_FRAME_COUNT);
    if (count >= 1.0 && count < 1e12) num_frames_ = static_cast<std::size_t>(std::llround(count));
  }

  std::vector<SourceImage> next(std::size_t max_images, std::vector<std::size_t>& damaged_frames) override {
    std::vector<SourceImage> images;
    while (images.size() < max_images && grab()) {
      const std::size_t frame = frame_++;
      has_grabbed_ = false;
      const std::int64_t time_ns = time_of(frame);
      if (!selection_.takes(frame, time_ns)) continue;
      cv::Mat gray = decoded();
      if (gray.empty()) {
        skip(frame, damaged_frames);
      } else {
        images.push_back({frame, time_ns, std::move(gray)});
      }
    }
    return images;
  }

  std::optional<std::size_t> estimated_size() const override {
    if (!num_frames_) return std::nullopt;
    const std::size_t by_count = (*num_frames_ + options_.every - 1) / options_.every;
    if (!options_.max_images_per_s || !(fps_ > 0.0)) return by_count;
    const double by_rate = static_cast<double>(*num_frames_) / fps_ * *options_.max_images_per_s;
    return std::min(by_count, static_cast<std::size_t>(std::ceil(by_rate)));
  }

 private:
  bool open() {
    try {
      return video_.open(path_.string());
    } catch (const cv::Exception&) {
      return false;
    }
  }

  /// Moves on to the next frame without the cost of colours.
  bool grab() {
    if (!has_grabbed_ && !has_ended_) {
      has_grabbed_ = video_.grab();
      if (!has_grabbed_) end();
    }
    return has_grabbed_;
  }

  void end() {
    has_ended_ = true;
    // Containers round, and decoders may keep the last frames back.
    constexpr std::size_t kTolerance = 2;
    const std::size_t expected = num_frames_.value_or(0);
    if (frame_ + std::max(kTolerance, expected / 100) >= expected) return;
    const std::string what = path_.string() + ": ends after " + std::to_string(frame_) + " of " + std::to_string(expected) +
                             " frames; was it copied completely?";
    if (options_.if_damaged == IfDamaged::Refuse) throw InputError(what);
    warn(what);
  }

  /// The container's time, where it has one that ascends; else by the frame rate, else 1 s apart.
  std::int64_t time_of(std::size_t frame) {
    const double time_ms = video_.get(cv::CAP_PROP_POS_MSEC);
    auto time_ns = static_cast<std::int64_t>(std::isfinite(time_ms) ? std::llround(time_ms * 1e6) : 0);
    if (frame > 0 && time_ns <= last_time_ns_) {
      const double step_ns = fps_ > 0.0 && std::isfinite(fps_) ? 1e9 / fps_ : 1e9;
      time_ns = last_time_ns_ + std::max<std::int64_t>(1, std::llround(step_ns));
    }
    return last_time_ns_ = time_ns;
  }

  cv::Mat decoded() {
    cv::Mat image, gray;
    try {
      if (!video_.retrieve(image) || image.empty()) return {};
      if (image.channels() == 1) return image.clone();
      cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
    } catch (const cv::Exception&) {
      return {};
    }
    return gray;
  }

  void skip(std::size_t frame, std::vector<std::size_t>& damaged_frames) const {
    const std::string what = path_.string() + ": frame " + std::to_string(frame) + " cannot be decoded";
    if (options_.if_damaged == IfDamaged::Refuse) throw InputError(what + "; copy the video again");
    damaged_frames.push_back(frame);
    warn(what + " (skipped)");
  }

  fs::path path_;
  cv::VideoCapture video_;
  double fps_ = 0.0;
  std::optional<std::size_t> num_frames_;
  std::size_t frame_ = 0;
  bool has_grabbed_ = false;  ///< A frame that was not given yet.
  bool has_ended_ = false;
  std::int64_t last_time_ns_ = 0;
};

ImageSource::ImageSource(const fs::path& path, const ImageSourceOptions& options) : name_(sequence_name(path)) {
  validate(options);
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    reader_ = std::make_unique<VideoReader>(path, options);
  } else {
    reader_ = std::make_unique<FolderReader>(path, options);
  }
}

ImageSource::~ImageSource() = default;
ImageSource::ImageSource(ImageSource&&) noexcept = default;
ImageSource& ImageSource::operator=(ImageSource&&) noexcept = default;

std::vector<SourceImage> ImageSource::next(std::size_t max_images) { return reader_->next(max_images, damaged_frames_); }

std::optional<std::size_t> ImageSource::estimated_size() const { return reader_->estimated_size(); }

}  // namespace fabloop
