// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/sequence/stamped_images.h"
#include "posegraph/sfm/colmap_io.h"
#include "posegraph/sfm/run_reader.h"
#include "posegraph/sfm/surface_products.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

struct SurfaceArguments {
  std::string model, images, camera, out;
  std::string up = "auto";
  std::string detail = "images";
  std::vector<double> origin;
  double resolution = 0;
  double max_slant_deg = OrthomosaicOptions{}.max_slant_deg;
  double memory_gb = 2;
  bool overwrite = false;
};

MapRun read_input(const SurfaceArguments& arguments, const CommonOptions& common) {
  MapRun run;
  if (fs::exists(fs::path(arguments.model) / "cameras.txt")) {
    run.reconstruction = read_colmap_model(arguments.model, arguments.images);
  } else if (fs::exists(fs::path(arguments.model) / "trajectory.tum")) {
    run = read_map_run(arguments.model, arguments.images, {.camera = arguments.camera, .warn = make_warn(common)});
  } else {
    throw InputError(
        arguments.model +
        ": is neither a run of `fabloop map` (trajectory.tum) nor a COLMAP text model (cameras.txt); give one of them");
  }
  if (!arguments.origin.empty()) {
    run.reconstruction.origin = GeoPosition{arguments.origin[0], arguments.origin[1], arguments.origin[2]};
    run.reconstruction.unit = LengthUnit::Metres;
  }
  return run;
}

void print_report(const SurfaceReport& report, const Reconstruction& reconstruction, const std::string& out) {
  const char* unit = reconstruction.unit == LengthUnit::Metres ? " m" : " units";
  std::cout << std::setprecision(3) << "ground:      " << report.ground_sampling << unit << " a pixel, " << report.flying_height
            << unit << " below the cameras, " << report.num_outliers << " of " << reconstruction.points.size()
            << " points left out\n"
            << "surface:     images agree on " << std::lround(100 * report.confident_part) << " % of it\n"
            << "orthomosaic: " << report.mosaic_columns << " x " << report.mosaic_rows << " pixels of " << report.resolution
            << unit;
  if (report.epsg) std::cout << ", EPSG:" << *report.epsg;
  std::cout << "\nseams:       views displaced by " << report.seams.median_px << " px (median of " << report.seams.num_places
            << " places), " << report.seams.p90_px << " px (90 %)\n"
            << "look at:     " << out << "/map_figure.png, " << out << "/orthomosaic" << (report.epsg ? ".tif" : ".png") << '\n';
}

void run_surface(const SurfaceArguments& arguments, const CommonOptions& common) {
  SurfaceProductsOptions options;
  options.if_exists = arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse;
  { const OutputFolder probe(arguments.out, options.if_exists); }  // before the work, not after it
  MapRun run = read_input(arguments, common);
  options.up = arguments.up == "z"       ? UpDirection::WorldZ
               : arguments.up == "plane" ? UpDirection::MeanPlane
                                         : UpDirection::Automatic;
  options.detail = arguments.detail == "points" ? SurfaceDetail::Points : SurfaceDetail::Images;
  if (arguments.resolution > 0) options.resolution = arguments.resolution;
  options.mosaic.max_slant_deg = arguments.max_slant_deg;
  constexpr double kBytesPerGb = 1e9;
  options.memory_budget_bytes = static_cast<std::size_t>(arguments.memory_gb * kBytesPerGb);
  options.odometry = std::move(run.odometry);
  options.loops = std::move(run.loops);
  options.name = sequence_name(arguments.images);
  options.num_threads = common.num_threads;
  options.progress = make_progress(common);
  options.warn = make_warn(common);
  print_report(write_surface_products(run.reconstruction, arguments.out, options), run.reconstruction, arguments.out);
}

}  // namespace

void add_surface_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<SurfaceArguments>();
  CLI::App* command = program.add_subcommand("surface", "heights, orthomosaic, textured mesh and figure of a map");
  command->add_option("MAP", arguments->model, "folder that `fabloop map` wrote, or a COLMAP text model")->required();
  command->add_option("--images", arguments->images, "folder of the map's images (itself or in images/)")->required();
  command->add_option("--camera", arguments->camera, "of a run: calibration file (default: camera.yaml beside the images)");
  command->add_option("--out", arguments->out, "folder to write")->required();
  command
      ->add_option("--resolution", arguments->resolution,
                   "width of an orthomosaic pixel on the ground (default: that of the images)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--max-slant", arguments->max_slant_deg,
                   "ground that no two views show from within so many degrees of the vertical is left out of the orthomosaic")
      ->check(CLI::Range(1.0, 90.0))
      ->capture_default_str();
  command->add_option("--detail", arguments->detail, "heights from the map's points alone, or from the images too")
      ->check(CLI::IsMember({"points", "images"}))
      ->capture_default_str();
  command
      ->add_option("--up", arguments->up,
                   "what is up: the world's z, the plane of the points' normal; auto: z where georeferenced, else the plane")
      ->check(CLI::IsMember({"auto", "z", "plane"}))
      ->capture_default_str();
  command
      ->add_option("--origin", arguments->origin,
                   "the world is east-north-up metres about this place: LATITUDE LONGITUDE ALTITUDE (degrees, WGS 84; metres)")
      ->expected(3);
  command->add_option("--memory", arguments->memory_gb, "budget for images, surface and mosaic [GB]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "replace what exists");
  command->callback([arguments, &common] { run_surface(*arguments, common); });
}

}  // namespace fabloop::apps
