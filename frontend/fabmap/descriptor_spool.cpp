// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/descriptor_spool.h"

#include <string>
#include <utility>

#include "frontend/error.h"

namespace fabloop {

DescriptorSpool::DescriptorSpool(std::filesystem::path path) : path_(std::move(path)) {
  file_.open(path_, std::ios::binary | std::ios::trunc);
  if (!file_) throw InputError(path_.string() + ": cannot be written; choose another place");
}

DescriptorSpool::~DescriptorSpool() {
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void DescriptorSpool::add(const cv::Mat& descriptors) {
  const cv::Mat whole = descriptors.isContinuous() ? descriptors : descriptors.clone();
  const std::size_t num_bytes = whole.total() * whole.elemSize();
  file_.write(reinterpret_cast<const char*>(whole.data), static_cast<std::streamsize>(num_bytes));
  // Flushed, since it is read through other streams.
  file_.flush();
  if (!file_) throw InputError(path_.string() + ": could not be written; free some space and run again");
  entries_.push_back({end_, whole.rows, whole.cols, whole.type()});
  end_ += num_bytes;
}

cv::Mat DescriptorSpool::read(std::size_t image) const {
  const Entry& entry = entries_.at(image);
  cv::Mat descriptors(entry.rows, entry.cols, entry.type);
  std::ifstream file(path_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(entry.offset));
  file.read(reinterpret_cast<char*>(descriptors.data),
            static_cast<std::streamsize>(descriptors.total() * descriptors.elemSize()));
  if (!file) throw InputError(path_.string() + ": could not be read back; run again on another disk");
  return descriptors;
}

}  // namespace fabloop
