// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>
#include <utility>

#include "frontend/error.h"
#include "frontend/sequence/image_folder.h"
#include "frontend/sequence/image_reader.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

class VideoReader : public ImageReader {
 public:
  VideoReader(const fs::path& path, const ImageSourceOptions& options) : ImageReader(options), path_(path) {
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
      SourceImage image = decoded();
      if (image.gray.empty()) {
        skip(frame, damaged_frames);
        continue;
      }
      image.frame = frame;
      image.time_ns = time_ns;
      images.push_back(std::move(image));
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
      // Where FFmpeg cannot read it no other can, and the others complain on the console, or look for cameras.
      const bool has_ffmpeg = cv::videoio_registry::hasBackend(cv::CAP_FFMPEG);
      return video_.open(path_.string(), has_ffmpeg ? cv::CAP_FFMPEG : cv::CAP_ANY);
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

  /// Without images where the frame cannot be decoded.
  SourceImage decoded() {
    cv::Mat image;
    SourceImage result;
    try {
      if (!video_.retrieve(image) || image.empty()) return {};
      if (image.channels() == 1) {
        result.gray = image.clone();
        if (options_.keep_colour) cv::cvtColor(image, result.colour, cv::COLOR_GRAY2BGR);
      } else {
        cv::cvtColor(image, result.gray, cv::COLOR_BGR2GRAY);
        if (options_.keep_colour) result.colour = image.clone();
      }
    } catch (const cv::Exception&) {
      return {};
    }
    return result;
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

}  // namespace

std::unique_ptr<ImageReader> make_video_reader(const fs::path& video, const ImageSourceOptions& options) {
  return std::make_unique<VideoReader>(video, options);
}

}  // namespace fabloop
