// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace fabloop {

/// Opens a file of OpenCV's FileStorage. Throws InputError naming it when it cannot be read or understood.
cv::FileStorage open_storage(const std::filesystem::path& path);

/// The matrix of that name as `type` (CV_32FC1 or CV_64FC1). Its head is compared with its data before anything is allocated.
/// Throws InputError naming the file when there is none, or it is empty, of several channels, of integers or truncated.
cv::Mat read_storage_matrix(const std::filesystem::path& path, const std::string& name, int type);

/// Writes one matrix under a name. Throws InputError when it cannot be written.
void write_storage_matrix(const std::filesystem::path& path, const std::string& name, const cv::Mat& matrix);

}  // namespace fabloop
