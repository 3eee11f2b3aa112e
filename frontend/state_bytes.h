// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// The content of a state file or of a keyframe map does not make sense. Caught where the file is read; never reaches the user.
class StateDamaged : public std::runtime_error {
 public:
  StateDamaged() : std::runtime_error("damaged content") {}
};

/// Numbers, vectors, matrices and poses one after another, as they lie in memory: what the files of a work state and keyframe
/// maps hold. They are read again in the order in which they were put. `take` throws StateDamaged where there is something else.
class StateBytes {
 public:
  StateBytes() = default;
  explicit StateBytes(std::string bytes) : bytes_(std::move(bytes)) {}

  const std::string& bytes() const { return bytes_; }
  bool at_end() const { return position_ == bytes_.size(); }

  template <typename T>
  void put(const T& number) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof(T));
  }

  template <typename T>
  void put(const std::vector<T>& numbers) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(static_cast<std::uint64_t>(numbers.size()));
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
  }

  void put(const cv::Mat& matrix) {
    put(static_cast<std::int32_t>(matrix.rows));
    put(static_cast<std::int32_t>(matrix.cols));
    put(static_cast<std::int32_t>(matrix.type()));
    const std::size_t row_size = static_cast<std::size_t>(matrix.cols) * matrix.elemSize();
    for (int row = 0; row < matrix.rows; ++row) bytes_.append(matrix.ptr<char>(row), row_size);
  }

  void put(const Pose& a_from_b) {
    for (const double value : a_from_b.translation) put(value);
    for (const double value : a_from_b.rotation.coeffs()) put(value);
  }

  template <typename T>
  void take(T& number) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(&number, next(sizeof(T)), sizeof(T));
  }

  template <typename T>
  void take(std::vector<T>& numbers) {
    std::uint64_t size = 0;
    take(size);
    if (size > (bytes_.size() - position_) / sizeof(T)) throw StateDamaged();
    numbers.resize(size);
    if (size > 0) std::memcpy(numbers.data(), next(size * sizeof(T)), size * sizeof(T));
  }

  void take(cv::Mat& matrix) {
    std::int32_t rows = 0, cols = 0, type = 0;
    take(rows);
    take(cols);
    take(type);
    if (rows < 0 || cols < 0 || (type != CV_32FC1 && type != CV_8UC1)) throw StateDamaged();
    const std::size_t size =
        static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols) * static_cast<std::size_t>(CV_ELEM_SIZE(type));
    if (size > bytes_.size() - position_) throw StateDamaged();
    matrix.create(rows, cols, type);
    if (size > 0) std::memcpy(matrix.data, next(size), size);
  }

  void take(Pose& a_from_b) {
    for (double& value : a_from_b.translation) take(value);
    for (double& value : a_from_b.rotation.coeffs()) take(value);
  }

 private:
  const char* next(std::size_t size) {
    if (size > bytes_.size() - position_) throw StateDamaged();
    const char* data = bytes_.data() + position_;
    position_ += size;
    return data;
  }

  std::string bytes_;
  std::size_t position_ = 0;
};

}  // namespace fabloop
