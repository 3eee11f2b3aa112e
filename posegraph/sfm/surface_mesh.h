// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/geometry/pose.h"
#include "posegraph/run/ply.h"
#include "posegraph/sfm/height_field.h"

namespace fabloop {

/// Triangles over coloured vertices; where they lie on a picture, in [0, 1] with v upwards.
struct SurfaceMesh {
  std::vector<ColouredPoint> vertices;
  std::vector<Eigen::Vector2d> texture_at;  ///< One a vertex.
  Triangles triangles;                      ///< Counter-clockwise seen from above.
};

/// A picture of the ground: what an orthomosaic is.
struct GroundPicture {
  const GroundGrid& grid;
  const cv::Mat3b& colour;  ///< BGR.
  const cv::Mat1b& shown;   ///< 255 where there is a picture.
};

/// The surface where the picture shows it as a mesh of at most about `max_vertices`, in the world's frame.
SurfaceMesh mesh_of(const HeightField& surface, const GroundPicture& picture, const Pose& world_from_ground,
                    std::size_t max_vertices);

/// The surface's cells that the images agreed on as points of at most about `max_points`, in the world's frame.
std::vector<ColouredPoint> dense_points(const HeightField& surface, const GroundPicture& picture, const Pose& world_from_ground,
                                        std::size_t max_points);

/// Writes `path` (.obj), and beside it the material (.mtl), which names `texture_file`.
void write_obj(const std::filesystem::path& path, const SurfaceMesh& mesh, const std::string& texture_file,
               const std::string& comment);

}  // namespace fabloop
