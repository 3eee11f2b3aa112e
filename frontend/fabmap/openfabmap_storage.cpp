// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/openfabmap_storage.h"

#include <fstream>
#include <limits>
#include <new>

#include "frontend/error.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_at(const fs::path& path, const std::string& what) { throw InputError(path.string() + ": " + what); }

/// OpenCV counts characters of a file in an int.
constexpr std::uintmax_t kMaxFileBytes = std::numeric_limits<std::int32_t>::max();

int required_int(const fs::path& path, const std::string& name, const cv::FileNode& matrix, const char* key) {
  const cv::FileNode node = matrix[key];
  if (!node.isInt() || static_cast<int>(node) <= 0) {
    fail_at(path, name + " has no " + key + " above zero; is it an OpenCV matrix?");
  }
  return static_cast<int>(node);
}

void require_numbers(const fs::path& path, const std::string& name, const cv::FileNode& matrix) {
  const int rows = required_int(path, name, matrix, "rows"), cols = required_int(path, name, matrix, "cols");
  const std::string type = matrix["dt"].isString() ? static_cast<std::string>(matrix["dt"]) : "";
  if (type != "f" && type != "d") {
    fail_at(path, name + " holds numbers of type \"" + type + "\" where openFABMAP has one float (f) or double (d) an entry");
  }
  const std::size_t expected = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  if (matrix["data"].size() != expected) {
    fail_at(path, name + " is " + std::to_string(rows) + " x " + std::to_string(cols) + " but has " +
                      std::to_string(matrix["data"].size()) + " numbers; is the file truncated?");
  }
}

}  // namespace

cv::FileStorage open_storage(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || !std::ifstream(path)) fail_at(path, "cannot be read; does it exist?");
  if (size == 0) fail_at(path, "is empty");
  if (size > kMaxFileBytes) fail_at(path, "is larger than the 2 GB that OpenCV's FileStorage can read; compress it (.gz)");
  try {
    cv::FileStorage storage(path.string(), cv::FileStorage::READ);
    if (!storage.isOpened() || storage.root().empty()) fail_at(path, "is no OpenCV FileStorage file (YAML, perhaps compressed)");
    return storage;
  } catch (const cv::Exception& exception) {
    fail_at(path, "is no OpenCV FileStorage file, or a damaged one (" + exception.err + ")");
  } catch (const std::bad_alloc&) {
    fail_at(path, "is too large for this machine's memory");
  }
}

cv::Mat read_storage_matrix(const fs::path& path, const std::string& name, int type) {
  const cv::FileStorage storage = open_storage(path);
  const cv::FileNode node = storage[name];
  if (!node.isMap()) fail_at(path, "has no matrix named " + name);
  require_numbers(path, name, node);
  cv::Mat matrix, result;
  try {
    node >> matrix;
    matrix.convertTo(result, type);
  } catch (const cv::Exception& exception) {
    fail_at(path, name + " cannot be understood (" + exception.err + ")");
  } catch (const std::bad_alloc&) {
    fail_at(path, "is too large for this machine's memory");
  }
  return result;
}

void write_storage_matrix(const fs::path& path, const std::string& name, const cv::Mat& matrix) {
  try {
    cv::FileStorage storage(path.string(), cv::FileStorage::WRITE);
    if (!storage.isOpened()) fail_at(path, "cannot be written; choose another place");
    storage << name << matrix;
  } catch (const cv::Exception& exception) {
    fail_at(path, "cannot be written (" + exception.err + ")");
  }
  // FileStorage does not tell when the disk is full.
  bool is_complete = false;
  try {
    is_complete = cv::norm(read_storage_matrix(path, name, matrix.type()), matrix, cv::NORM_INF) == 0.0;
  } catch (const InputError&) {
  }
  if (!is_complete) fail_at(path, "could not be written completely; free some space and run again");
}

}  // namespace fabloop
