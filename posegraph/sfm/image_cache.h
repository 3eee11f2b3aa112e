// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <condition_variable>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// An image and its halves: level 0 is the image itself, each further level half as wide (averages).
struct ImagePyramid {
  static constexpr int kLevels = 5;
  std::vector<cv::Mat3b> colour;  ///< BGR, kLevels.
  std::vector<cv::Mat1b> grey;    ///< kLevels.

  /// Where a pixel of the image lies on a level.
  Eigen::Vector2d on_level(const Eigen::Vector2d& pixel, int level) const {
    const double sx = static_cast<double>(grey[level].cols) / grey[0].cols;
    const double sy = static_cast<double>(grey[level].rows) / grey[0].rows;
    return {(pixel.x() + 0.5) * sx - 0.5, (pixel.y() + 0.5) * sy - 0.5};
  }
};

/// The images of a reconstruction, read when they are asked for and kept within a budget of bytes; what was used longest ago
/// goes first. Safe in parallel. Keeps a reference to the reconstruction, which must outlive it.
class ImageCache {
 public:
  ImageCache(const Reconstruction& reconstruction, std::size_t budget_bytes);

  /// The image; it lives as long as it is held, also when the cache lets it go. Throws InputError naming the file when it is
  /// missing, damaged or of another size than its camera's.
  std::shared_ptr<const ImagePyramid> get(std::size_t image);

  /// How often an image was read from its file.
  std::size_t num_reads() const;

 private:
  struct Entry {
    std::shared_ptr<const ImagePyramid> pyramid;
    std::list<std::size_t>::iterator use;
  };

  void insert(std::size_t image, const std::shared_ptr<const ImagePyramid>& pyramid);

  const Reconstruction& reconstruction_;
  std::size_t budget_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable is_read_;
  std::unordered_set<std::size_t> being_read_;  ///< By a thread that others wait for.
  std::unordered_map<std::size_t, Entry> entries_;
  std::list<std::size_t> uses_;  ///< The latest first.
  std::size_t bytes_ = 0;
  std::size_t num_reads_ = 0;
};

}  // namespace fabloop
