// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/image_cache.h"

#include <opencv2/imgproc.hpp>

#include "frontend/sequence/sequence.h"

namespace fabloop {
namespace {

std::shared_ptr<const ImagePyramid> make_pyramid(const cv::Mat3b& image) {
  auto pyramid = std::make_shared<ImagePyramid>();
  pyramid->colour.push_back(image);
  for (int level = 1; level < ImagePyramid::kLevels; ++level) {
    const cv::Mat3b& finer = pyramid->colour.back();
    cv::Mat3b half;
    cv::resize(finer, half, {std::max(1, finer.cols / 2), std::max(1, finer.rows / 2)}, 0, 0, cv::INTER_AREA);
    pyramid->colour.push_back(half);
  }
  for (const cv::Mat3b& colour : pyramid->colour) {
    cv::Mat1b grey;
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    pyramid->grey.push_back(grey);
  }
  return pyramid;
}

std::size_t bytes_of(const ImagePyramid& pyramid) {
  std::size_t bytes = 0;
  for (const cv::Mat3b& colour : pyramid.colour) bytes += colour.total() * 4;  // three of colour, one of grey
  return bytes;
}

}  // namespace

ImageCache::ImageCache(const Reconstruction& reconstruction, std::size_t budget_bytes)
    : reconstruction_(reconstruction), budget_bytes_(budget_bytes) {}

std::shared_ptr<const ImagePyramid> ImageCache::get(std::size_t image) {
  {
    std::unique_lock lock(mutex_);
    is_read_.wait(lock, [&] { return !being_read_.contains(image); });
    if (const auto found = entries_.find(image); found != entries_.end()) {
      uses_.splice(uses_.begin(), uses_, found->second.use);
      return found->second.pyramid;
    }
    being_read_.insert(image);
    ++num_reads_;
  }
  // Decoded outside of the lock: threads that want other images go on.
  std::shared_ptr<const ImagePyramid> pyramid;
  const auto finish = [&] {
    const std::scoped_lock lock(mutex_);
    being_read_.erase(image);
    if (pyramid) insert(image, pyramid);
    is_read_.notify_all();
  };
  try {
    const PlacedImage& placed = reconstruction_.images[image];
    pyramid = make_pyramid(read_colour_image(placed.image_path, reconstruction_.cameras[placed.camera]));
  } catch (...) {
    finish();
    throw;
  }
  finish();
  return pyramid;
}

void ImageCache::insert(std::size_t image, const std::shared_ptr<const ImagePyramid>& pyramid) {
  bytes_ += bytes_of(*pyramid);
  uses_.push_front(image);
  entries_[image] = {pyramid, uses_.begin()};
  while (bytes_ > budget_bytes_ && uses_.size() > 1) {
    const auto oldest = entries_.find(uses_.back());
    bytes_ -= bytes_of(*oldest->second.pyramid);
    entries_.erase(oldest);
    uses_.pop_back();
  }
}

std::size_t ImageCache::num_reads() const {
  const std::scoped_lock lock(mutex_);
  return num_reads_;
}

}  // namespace fabloop
