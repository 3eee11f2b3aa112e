// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cstring>
#include <iomanip>
#include <limits>

#include "frontend/output_file.h"
#include "posegraph/sfm/surface_mesh.h"

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

void write_ply(const std::filesystem::path& path, const SurfaceMesh& mesh, const std::string& comment) {
  const std::string head = vertex_head(mesh.vertices.size(), comment) + "element face " + std::to_string(mesh.triangles.size()) +
                           "\nproperty list uchar uint vertex_indices\nend_header\n";
  const std::string vertices = vertex_bytes(mesh.vertices);
  std::string faces;
  faces.reserve(mesh.triangles.size() * 13);
  for (const auto& triangle : mesh.triangles) {
    append(faces, static_cast<std::uint8_t>(3));
    for (const std::uint32_t index : triangle) append(faces, index);
  }
  write_parts(path, {&head, &vertices, &faces});
}

void write_obj(const std::filesystem::path& path, const SurfaceMesh& mesh, const std::string& texture_file,
               const std::string& comment) {
  std::filesystem::path material = path;
  material.replace_extension(".mtl");
  OutputFile material_file(material);
  material_file.stream() << "newmtl ground\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " << texture_file << '\n';
  material_file.commit();
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "# " << comment << "\nmtllib " << material.filename().string() << "\nusemtl ground\n"
      << std::fixed << std::setprecision(4);
  for (const ColouredPoint& vertex : mesh.vertices) {
    out << "v " << vertex.x_in_world.x() << ' ' << vertex.x_in_world.y() << ' ' << vertex.x_in_world.z() << '\n';
  }
  out << std::setprecision(6);
  for (const Eigen::Vector2d& at : mesh.texture_at) out << "vt " << at.x() << ' ' << at.y() << '\n';
  for (const auto& t : mesh.triangles) {
    out << "f " << t[0] + 1 << '/' << t[0] + 1 << ' ' << t[1] + 1 << '/' << t[1] + 1 << ' ' << t[2] + 1 << '/' << t[2] + 1
        << '\n';
  }
  file.commit();
}

}  // namespace fabloop
