// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// Descriptors of many images, kept in a file, for sources that give each image only once. The file goes with the object.
class DescriptorSpool {
 public:
  /// Throws InputError when the file cannot be created.
  explicit DescriptorSpool(std::filesystem::path path);
  ~DescriptorSpool();
  DescriptorSpool(const DescriptorSpool&) = delete;
  DescriptorSpool& operator=(const DescriptorSpool&) = delete;

  /// The descriptors (N x D) of the next image. Throws InputError when the disk is full.
  void add(const cv::Mat& descriptors);

  /// Those of an image that was added. Safe from several threads, but not beside add(). Throws InputError when they cannot be
  /// read back.
  cv::Mat read(std::size_t image) const;

  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    std::uint64_t offset;
    int rows, cols, type;
  };

  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t end_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace fabloop
