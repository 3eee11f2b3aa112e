// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/mapped_file.h"

#include <cassert>
#include <memory>
#include <utility>

#include "frontend/error.h"

#if __has_include(<sys/mman.h>)
#define FABLOOP_HAS_MMAP 1
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#else
#define FABLOOP_HAS_MMAP 0
#include <fstream>
#include <new>
#endif

namespace fabloop {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw InputError(path.string() + ": cannot be read; give a file that exists and that you may read");
}

/// Frees what a matrix_of() points into. OpenCV calls it when the last copy of the matrix is gone.
class FileOwner final : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int, const int*, int, void*, std::size_t*, cv::AccessFlag, cv::UMatUsageFlags) const override {
    return nullptr;
  }
  bool allocate(cv::UMatData*, cv::AccessFlag, cv::UMatUsageFlags) const override { return false; }
  void deallocate(cv::UMatData* data) const override {
    delete static_cast<MappedFile*>(data->userdata);
    data->userdata = nullptr;
    delete data;
  }
};

#if FABLOOP_HAS_MMAP

/// Closes a file when it goes out of scope; a mapping does not need it open.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path) : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

#else

constexpr std::align_val_t kMappedAlignment{64};

#endif

}  // namespace

#if FABLOOP_HAS_MMAP

MappedFile::MappedFile(const std::filesystem::path& path) {
  const Descriptor file(path);
  struct stat status {};
  if (file.number() < 0 || ::fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) fail(path);
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ == 0) return;
  void* address = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.number(), 0);
  if (address == MAP_FAILED) fail(path);
  ::madvise(address, size_, MADV_WILLNEED);
  data_ = static_cast<std::byte*>(address);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

#else

MappedFile::MappedFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  size_ = static_cast<std::size_t>(std::filesystem::file_size(path, error));
  if (error || !file) fail(path);
  if (size_ == 0) return;
  data_ = static_cast<std::byte*>(::operator new(size_, kMappedAlignment));
  file.read(reinterpret_cast<char*>(data_), static_cast<std::streamsize>(size_));
  if (file) return;
  ::operator delete(data_, kMappedAlignment);
  fail(path);
}

MappedFile::~MappedFile() { ::operator delete(data_, kMappedAlignment); }

#endif

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

cv::Mat matrix_of(MappedFile file, std::size_t offset, int rows, int columns, int type) {
  static const FileOwner owner;
  [[maybe_unused]] const std::size_t size =
      static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) * static_cast<std::size_t>(CV_ELEM_SIZE(type));
  assert(offset <= file.size() && size <= file.size() - offset);
  std::byte* begin = file.data_ + offset;
  auto owned = std::make_unique<MappedFile>(std::move(file));
  auto data = std::make_unique<cv::UMatData>(&owner);
  cv::Mat matrix(rows, columns, type, begin);
  data->data = data->origdata = matrix.data;
  data->size = size;
  data->userdata = owned.release();
  data->refcount = 1;
  matrix.u = data.release();
  return matrix;
}

}  // namespace fabloop
