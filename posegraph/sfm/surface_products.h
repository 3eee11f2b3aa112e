// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/output_file.h"
#include "frontend/progress.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/sfm/dense_surface.h"
#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/loop_link.h"
#include "posegraph/sfm/orthomosaic.h"
#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// Where heights come from.
enum class SurfaceDetail {
  Points,  ///< The reconstruction's points alone: quick and smooth; what stands up is blurred in the mosaic.
  Images,  ///< Also a plane sweep through the images.
};

struct SurfaceProductsOptions {
  UpDirection up = UpDirection::Automatic;
  SurfaceDetail detail = SurfaceDetail::Images;
  /// Width of a mosaic pixel on the ground, in the reconstruction's unit. None: that of the images' pixels.
  std::optional<double> resolution{};
  /// Images, surface and mosaic together keep within about this; the mosaic is made coarser where it must be.
  std::size_t memory_budget_bytes = std::size_t{2} << 30;
  std::size_t max_mesh_vertices = 200'000;
  std::size_t max_dense_points = 2'000'000;
  DenseSurfaceOptions surface;
  OrthomosaicOptions mosaic;
  Trajectory odometry{};          ///< What was believed before loops were closed: for the figure. May be empty.
  std::vector<LoopLink> loops{};  ///< Accepted loops: for the figure and the track's files.
  std::string name = "map";       ///< A title for the figure and the files.
  int num_threads = 0;            ///< 0: all. What is written does not depend on it.
  OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse;
  Progress progress;
  Warn warn;
};

/// What was made, in figures.
struct SurfaceReport {
  double ground_sampling = 0;  ///< Median width of an image's pixel on the ground.
  double resolution = 0;       ///< Width of a mosaic pixel.
  double flying_height = 0;    ///< Median, above the surface.
  int mosaic_rows = 0;
  int mosaic_columns = 0;
  double shown_area = 0;            ///< Ground that the mosaic shows, in square units.
  double confident_part = 0;        ///< Of it: where the images agreed on a height.
  std::size_t num_outliers = 0;     ///< Points left out of the surface.
  std::size_t num_image_reads = 0;  ///< As many as images where the budget holds them all.
  SeamResidual seams;
  std::optional<int> epsg;  ///< Of the GeoTIFFs.
};

/// Makes the surface of a reconstruction, and writes into `folder`:
/// - orthomosaic.tif (GeoTIFF, UTM) where it is georeferenced, else orthomosaic.png and its world file orthomosaic.pgw;
/// - surface.tif (heights, 32-bit float, NaN where unknown), with surface.tfw where it is not georeferenced;
/// - mesh.obj, mesh.mtl, texture.jpg; mesh.ply and points.ply (the dense points) with colours: in the reconstruction's world;
/// - map_figure.png: the textured map with the trajectory, and the loops over the odometry;
/// - colmap/: the reconstruction as a COLMAP text model; where georeferenced geo.txt, track.kml, track.geojson;
/// - surface.json: the figures of the report, the unit and ground_from_world.
/// The folder appears when it is complete. Throws InputError: no images, too few points, images that cannot be read, a folder
/// that exists.
SurfaceReport write_surface_products(const Reconstruction& reconstruction, const std::filesystem::path& folder,
                                     const SurfaceProductsOptions& options = {});

}  // namespace fabloop
