// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/surface_products.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "frontend/error.h"
#include "posegraph/sfm/colmap_io.h"
#include "posegraph/sfm/geo_exchange.h"
#include "posegraph/sfm/map_figure.h"
#include "posegraph/sfm/raster_output.h"
#include "posegraph/sfm/surface_mesh.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// What a mosaic pixel takes beside the images: its colour and mask, and its part of a block.
constexpr std::size_t kBytesPerPixel = 10;

void require_usable(const Reconstruction& reconstruction) {
  if (reconstruction.images.empty()) throw InputError("the reconstruction has no placed images, so there is nothing to show");
  for (const PlacedImage& image : reconstruction.images) {
    if (image.camera >= reconstruction.cameras.size()) {
      throw InputError(image.image_path.string() + ": its camera is not in the reconstruction");
    }
  }
}

/// The rectangle of ground that enough views show.
std::pair<Eigen::Vector2d, Eigen::Vector2d> covered_area(const HeightField& field, const std::vector<GroundView>& views,
                                                         int min_views) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = -low;
  const auto count = [&](const Eigen::Vector2d& x) {
    const Eigen::Vector3d point(x.x(), x.y(), height_at(field, x));
    return std::count_if(views.begin(), views.end(), [&](const GroundView& view) { return view.pixel_of(point).has_value(); });
  };
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(field.heights.total()) / 10'000)));
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(stride * field.grid.spacing);
  for (int row = 0; row < field.grid.rows; row += stride) {
    for (int column = 0; column < field.grid.columns; column += stride) {
      const Eigen::Vector2d x = field.grid.ground_at(column, row);
      if (count(x) < min_views) continue;
      low = low.cwiseMin(x - margin);
      high = high.cwiseMax(x + margin);
    }
  }
  if (!(low.x() < high.x())) throw InputError("no place on the ground is shown by enough images; do they overlap?");
  return {low, high};
}

GroundGrid mosaic_grid(const SparseSurface& sparse, const std::vector<GroundView>& views, const SurfaceProductsOptions& options) {
  const auto [low, high] = covered_area(sparse.field, views, options.mosaic.min_views);
  const double most_pixels = static_cast<double>(options.memory_budget_bytes / 4 / kBytesPerPixel);
  const double wanted = options.resolution.value_or(sparse.ground_sampling);
  if (!(wanted > 0)) throw InputError("the resolution is not positive; give the width of a pixel on the ground");
  const double least = std::sqrt((high - low).prod() / most_pixels);
  if (least > wanted && options.warn) {
    options.warn("the mosaic's pixels are " + std::to_string(least) + " wide instead of " + std::to_string(wanted) +
                 ", to keep within the memory budget");
  }
  return grid_over(low, high, std::max(wanted, least));
}

/// The part of the mosaic that shows anything.
Orthomosaic cropped(const Orthomosaic& mosaic) {
  const cv::Rect box = cv::boundingRect(mosaic.shown);
  if (box.area() == 0) {
    throw InputError(
        "no place on the ground is shown by enough images from above; do they overlap, and do they look down? --max-slant "
        "lets images count that look farther aslant");
  }
  GroundGrid grid = mosaic.grid;
  grid.first_centre = mosaic.grid.ground_at(box.x, box.y);
  grid.rows = box.height;
  grid.columns = box.width;
  return {grid, mosaic.colour(box).clone(), mosaic.shown(box).clone(), mosaic.residual};
}

cv::Mat1b shown_cells(const HeightField& surface, const Orthomosaic& mosaic) {
  cv::Mat1b shown(surface.heights.size(), static_cast<unsigned char>(0));
  for (int row = 0; row < shown.rows; ++row) {
    for (int column = 0; column < shown.cols; ++column) {
      const Eigen::Vector2d at = mosaic.grid.position_of(surface.grid.ground_at(column, row));
      const cv::Point pixel(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
      if (cv::Rect(0, 0, mosaic.shown.cols, mosaic.shown.rows).contains(pixel)) shown(row, column) = mosaic.shown(pixel);
    }
  }
  return shown;
}

void write_rasters(const fs::path& folder, const HeightField& surface, const Orthomosaic& mosaic, const cv::Mat1b& cells,
                   const std::optional<MapGrid>& map) {
  write_tiff(folder / "surface.tif", surface.grid, surface.heights, cells, map);
  if (map) {
    write_tiff(folder / "orthomosaic.tif", mosaic.grid, mosaic.colour, mosaic.shown, map);
    return;
  }
  write_world_file(folder / "surface.tfw", surface.grid);
  write_png(folder / "orthomosaic.png", mosaic.colour, mosaic.shown);
  write_world_file(folder / "orthomosaic.pgw", mosaic.grid);
}

void write_texture(const fs::path& path, const Orthomosaic& mosaic) {
  constexpr int kMostPixels = 8192;  // what graphics cards and viewers take
  const double scale = std::min(1.0, static_cast<double>(kMostPixels) / std::max(mosaic.colour.cols, mosaic.colour.rows));
  cv::Mat texture = mosaic.colour;
  if (scale < 1) cv::resize(mosaic.colour, texture, {}, scale, scale, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", texture, bytes, {cv::IMWRITE_JPEG_QUALITY, 92})) {
    throw InputError(path.string() + ": the picture could not be encoded as JPEG");
  }
  write_bytes(path, {bytes.begin(), bytes.end()});
}

void write_meshes(const fs::path& folder, const HeightField& surface, const Orthomosaic& mosaic, const Pose& world_from_ground,
                  const std::string& comment, const SurfaceProductsOptions& options) {
  const GroundPicture picture{mosaic.grid, mosaic.colour, mosaic.shown};
  const SurfaceMesh mesh = mesh_of(surface, picture, world_from_ground, options.max_mesh_vertices);
  write_ply(folder / "mesh.ply", mesh.vertices, mesh.triangles, comment);
  write_obj(folder / "mesh.obj", mesh, "texture.jpg", comment);
  write_texture(folder / "texture.jpg", mosaic);
  write_ply(folder / "points.ply", dense_points(surface, picture, world_from_ground, options.max_dense_points), comment);
}

SurfaceReport report_of(const SparseSurface& sparse, const HeightField& surface, const Orthomosaic& mosaic,
                        const cv::Mat1b& cells, std::size_t num_reads, const std::optional<MapGrid>& map) {
  SurfaceReport report;
  report.ground_sampling = sparse.ground_sampling;
  report.resolution = mosaic.grid.spacing;
  report.flying_height = sparse.flying_height;
  report.mosaic_rows = mosaic.grid.rows;
  report.mosaic_columns = mosaic.grid.columns;
  report.shown_area = cv::countNonZero(mosaic.shown) * mosaic.grid.spacing * mosaic.grid.spacing;
  constexpr float kSure = 0.25F;
  const double num_shown = std::max(1, cv::countNonZero(cells));
  report.confident_part = cv::countNonZero((surface.confidence >= kSure) & cells) / num_shown;
  report.num_outliers = sparse.num_outliers;
  report.num_image_reads = num_reads;
  report.seams = mosaic.residual;
  if (map) report.epsg = map->epsg;
  return report;
}

void write_report(const fs::path& path, const SurfaceReport& report, const Reconstruction& reconstruction,
                  const Pose& ground_from_world) {
  nlohmann::ordered_json json;
  json["unit"] = reconstruction.unit == LengthUnit::Metres ? "metre" : "arbitrary";
  json["num_images"] = reconstruction.images.size();
  json["num_points"] = reconstruction.points.size();
  json["num_outlier_points"] = report.num_outliers;
  json["num_image_reads"] = report.num_image_reads;
  json["flying_height"] = report.flying_height;
  json["ground_sampling"] = report.ground_sampling;
  json["resolution"] = report.resolution;
  json["mosaic_columns"] = report.mosaic_columns;
  json["mosaic_rows"] = report.mosaic_rows;
  json["shown_area"] = report.shown_area;
  json["confident_part"] = report.confident_part;
  json["seam_residual_median_px"] = report.seams.median_px;
  json["seam_residual_p90_px"] = report.seams.p90_px;
  json["seam_places"] = report.seams.num_places;
  if (report.epsg) json["epsg"] = *report.epsg;
  if (reconstruction.origin) {
    json["origin"] = {{"latitude_deg", reconstruction.origin->latitude_deg},
                      {"longitude_deg", reconstruction.origin->longitude_deg},
                      {"altitude_m", reconstruction.origin->altitude_m}};
  }
  const Eigen::Quaterniond& q = ground_from_world.rotation;
  json["ground_from_world_qxyzw"] = {q.x(), q.y(), q.z(), q.w()};
  write_bytes(path, json.dump(2) + "\n");
}

}  // namespace

SurfaceReport write_surface_products(const Reconstruction& reconstruction, const fs::path& folder,
                                     const SurfaceProductsOptions& options) {
  require_usable(reconstruction);
  OutputFolder output(folder, options.if_exists);
  const fs::path& part = output.part_path();
  const Pose to_ground = ground_from_world(reconstruction, options.up);
  const std::vector<GroundView> views = ground_views(reconstruction, to_ground);
  std::vector<Eigen::Vector3d> points;
  for (const ScenePoint& point : reconstruction.points) points.push_back(to_ground * point.x_in_world);
  std::vector<std::size_t> camera_of;
  for (const PlacedImage& image : reconstruction.images) camera_of.push_back(image.camera);

  const SparseSurface sparse = sparse_surface(points, views);
  ImageCache images(reconstruction, options.memory_budget_bytes / 2);
  DenseSurfaceOptions surface_options = options.surface;
  constexpr std::size_t kBytesPerCell = 24;
  surface_options.max_cells = std::min(surface_options.max_cells, options.memory_budget_bytes / 4 / kBytesPerCell);
  surface_options.sweep.num_threads = options.num_threads;
  surface_options.sweep.progress = options.progress;
  const HeightField surface =
      options.detail == SurfaceDetail::Images ? dense_surface(sparse, views, images, surface_options) : sparse.field;

  OrthomosaicOptions mosaic_options = options.mosaic;
  mosaic_options.num_threads = options.num_threads;
  mosaic_options.progress = options.progress;
  const Orthomosaic mosaic =
      cropped(make_orthomosaic(mosaic_grid(sparse, views, options), surface, views, camera_of, reconstruction.cameras.size(),
                               images, sparse.flying_height, mosaic_options));

  const std::optional<MapGrid> map = reconstruction.origin ? std::optional(map_grid_at(*reconstruction.origin)) : std::nullopt;
  const cv::Mat1b cells = shown_cells(surface, mosaic);
  write_rasters(part, surface, mosaic, cells, map);
  const std::string comment =
      options.name + (reconstruction.unit == LengthUnit::Metres ? ", metres" : ", arbitrary unit of length");
  write_meshes(part, surface, mosaic, to_ground.inverse(), comment, options);
  write_map_figure(
      part / "map_figure.png",
      {reconstruction, to_ground, {mosaic.grid, mosaic.colour, mosaic.shown}, options.odometry, options.loops, options.name});
  write_colmap_model(part / "colmap", reconstruction);
  if (reconstruction.origin) {
    write_geo_txt(part / "geo.txt", reconstruction);
    write_track_kml(part / "track.kml", reconstruction, options.loops, options.name);
    write_track_geojson(part / "track.geojson", reconstruction, options.loops, options.name);
  }
  const SurfaceReport report = report_of(sparse, surface, mosaic, cells, images.num_reads(), map);
  write_report(part / "surface.json", report, reconstruction, to_ground);
  output.commit();
  return report;
}

}  // namespace fabloop
