// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <opencv2/core/matx.hpp>
#include <string>
#include <vector>

namespace fabloop {

/// A point or a vertex with its colour.
struct ColouredPoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  cv::Vec3b red_green_blue{0, 0, 0};
};

/// Corners of triangles, by the positions of their vertices.
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Writes points as binary little-endian PLY: float x y z, uchar red green blue. `comment` says in the head what their world is.
/// Throws InputError when the file cannot be written.
void write_ply(const std::filesystem::path& path, const std::vector<ColouredPoint>& points, const std::string& comment);

/// The same of vertices with triangles over them (`vertex_indices`).
void write_ply(const std::filesystem::path& path, const std::vector<ColouredPoint>& vertices, const Triangles& triangles,
               const std::string& comment);

}  // namespace fabloop
