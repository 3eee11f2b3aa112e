// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "posegraph/sfm/geodesy.h"
#include "posegraph/sfm/ground_grid.h"

namespace fabloop {

/// Writes a raster as tiled, compressed TIFF: colours (CV_8UC3, BGR) with `shown` as their alpha, or heights (CV_32F) with NaN
/// where there are none. On a map grid it is a GeoTIFF, north up, the ground's x, y being metres on the grid before its scale.
/// Without one, the same file has no georeference. Throws InputError when it cannot be written.
void write_tiff(const std::filesystem::path& path, const GroundGrid& grid, const cv::Mat& raster, const cv::Mat1b& shown,
                const std::optional<MapGrid>& map);

/// Writes colours as PNG, transparent where they are not shown.
void write_png(const std::filesystem::path& path, const cv::Mat3b& colour, const cv::Mat1b& shown);

/// Writes a world file: six lines, cell width, 0, 0, minus cell height, x and y of the first cell's centre.
void write_world_file(const std::filesystem::path& path, const GroundGrid& grid);

/// Bytes to a file that appears when it is complete.
void write_bytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace fabloop
