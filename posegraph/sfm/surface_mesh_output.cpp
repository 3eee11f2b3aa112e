// SPDX-License-Identifier: BSD-3-Clause
#include <iomanip>
#include <limits>

#include "frontend/output_file.h"
#include "posegraph/sfm/surface_mesh.h"

namespace fabloop {

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
