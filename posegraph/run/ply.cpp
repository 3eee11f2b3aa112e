// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/ply.h"

#include <bit>
#include <cstring>
#include <initializer_list>

#include "frontend/output_file.h"

namespace fabloop {
namespace {

template <typename Number>
void append(std::string& bytes, Number value) {
  static_assert(std::endian::native == std::endian::little, "the PLY header promises little-endian numbers");
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &value, sizeof(Number));
  bytes.append(raw.data(), raw.size());
}

std::string vertex_bytes(const std::vector<ColouredPoint>& points) {
  std::string bytes;
  bytes.reserve(points.size() * 15);
  for (const ColouredPoint& point : points) {
    for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(point.x_in_world(k)));
    for (int k = 0; k < 3; ++k) append(bytes, point.red_green_blue[k]);
  }
  return bytes;
}

std::string vertex_head(std::size_t count, const std::string& comment) {
  return "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
         "blue\n";
}

void write_parts(const std::filesystem::path& path, std::initializer_list<const std::string*> parts) {
  OutputFile file(path);
  for (const std::string* part : parts) file.stream().write(part->data(), static_cast<std::streamsize>(part->size()));
  file.commit();
}

}  // namespace

void write_ply(const std::filesystem::path& path, const std::vector<ColouredPoint>& points, const std::string& comment) {
  const std::string head = vertex_head(points.size(), comment) + "end_header\n";
  const std::string vertices = vertex_bytes(points);
  write_parts(path, {&head, &vertices});
}

void write_ply(const std::filesystem::path& path, const std::vector<ColouredPoint>& vertices, const Triangles& triangles,
               const std::string& comment) {
  const std::string head = vertex_head(vertices.size(), comment) + "element face " + std::to_string(triangles.size()) +
                           "\nproperty list uchar uint vertex_indices\nend_header\n";
  const std::string vertex_part = vertex_bytes(vertices);
  std::string faces;
  faces.reserve(triangles.size() * 13);
  for (const auto& triangle : triangles) {
    append(faces, static_cast<std::uint8_t>(3));
    for (const std::uint32_t index : triangle) append(faces, index);
  }
  write_parts(path, {&head, &vertex_part, &faces});
}

}  // namespace fabloop
