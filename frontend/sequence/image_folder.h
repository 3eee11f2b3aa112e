// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fabloop {

/// The image files (by extension: jpg, jpeg, png, tif, tiff, bmp, pgm, ppm, webp) of a folder, in the order of their names, in
/// which runs of digits count as numbers: img9 comes before img10. Empty when there are none or the folder cannot be read.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

/// Whether the file's extension is that of an image.
bool is_image_file(const std::filesystem::path& path);

/// The time that an image's file name is, where it is one: seconds with a decimal point or of up to 10 digits
/// ("1305031102.175304.png", "1500000000.jpg", "0042.png"), nanoseconds of more digits ("1403636579763555584.png").
std::optional<std::int64_t> time_from_filename(const std::filesystem::path& image_path);

}  // namespace fabloop
