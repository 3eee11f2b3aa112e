// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/orthomosaic.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/sfm/bump_world.h"

namespace fabloop {
namespace {

using test::BumpWorld;
using test::ScratchFolder;

HeightField true_surface(const BumpWorld& world, double spacing) {
  HeightField field{grid_over({-20, -16}, {20, 16}, spacing), {}, {}};
  field.heights = cv::Mat1f(field.grid.rows, field.grid.columns);
  field.confidence = cv::Mat1f(field.grid.rows, field.grid.columns, 1.0F);
  for (int row = 0; row < field.grid.rows; ++row) {
    for (int column = 0; column < field.grid.columns; ++column) {
      const Eigen::Vector2d x = field.grid.ground_at(column, row);
      field.heights(row, column) = static_cast<float>(world.height_at(x.x(), x.y()));
    }
  }
  return field;
}

Orthomosaic mosaic_of(const BumpWorld& world, const Reconstruction& reconstruction, int num_threads = 1,
                      double max_slant_deg = OrthomosaicOptions{}.max_slant_deg) {
  ImageCache images(reconstruction, 1 << 24);
  OrthomosaicOptions options;
  options.num_threads = num_threads;
  options.max_slant_deg = max_slant_deg;
  const std::vector<std::size_t> camera_of(reconstruction.images.size(), 0);
  return make_orthomosaic(grid_over({-12, -9}, {12, 9}, 0.2), true_surface(world, 0.25), ground_views(reconstruction, {}),
                          camera_of, 1, images, world.flying_height, options);
}

/// Mean absolute difference to the true pattern [grey values], after the brightness as a whole.
double pattern_error(const Orthomosaic& mosaic) {
  double sum = 0, scale = 0, truth = 0;
  int count = 0;
  for (const bool is_scaled : {false, true}) {
    for (int row = 0; row < mosaic.grid.rows; ++row) {
      for (int column = 0; column < mosaic.grid.columns; ++column) {
        if (mosaic.shown(row, column) == 0) continue;
        const Eigen::Vector2d x = mosaic.grid.ground_at(column, row);
        const double wanted = BumpWorld::pattern(x.x(), x.y());
        if (is_scaled) {
          sum += std::abs(mosaic.colour(row, column)[0] * truth / scale - wanted);
          ++count;
        } else {
          scale += mosaic.colour(row, column)[0];
          truth += wanted;
        }
      }
    }
  }
  return sum / count;
}

TEST(Orthomosaic, ShowsTheGroundWhereItIs) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Orthomosaic mosaic = mosaic_of(world, world.reconstruction(folder.path()));
  EXPECT_EQ(cv::countNonZero(mosaic.shown), mosaic.grid.rows * mosaic.grid.columns) << "no holes";
  // Interpolation between pixels 0.2 m apart of waves 1.4 m long, twice; a shift by half a pixel would make 5 grey values.
  EXPECT_LT(pattern_error(mosaic), 2.5);
  ASSERT_GT(mosaic.residual.num_places, 0U);
  EXPECT_LT(mosaic.residual.median_px, 0.3);
}

TEST(Orthomosaic, MakesExposuresEqual) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Orthomosaic mosaic = mosaic_of(world, world.reconstruction(folder.path(), 0.15));
  EXPECT_LT(pattern_error(mosaic), 3.0);  // left alone, every second picture would be 19 grey values off
}

TEST(Orthomosaic, KeepsConstantImagesConstant) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Reconstruction reconstruction = world.reconstruction(folder.path());
  for (const PlacedImage& image : reconstruction.images) {
    cv::imwrite(image.image_path.string(), cv::Mat3b(world.height, world.width, cv::Vec3b(60, 120, 180)));
  }
  const Orthomosaic mosaic = mosaic_of(world, reconstruction);
  for (int row = 0; row < mosaic.grid.rows; ++row) {
    for (int column = 0; column < mosaic.grid.columns; ++column) {
      // The blender's pyramids are of whole numbers and cut off at every of its five levels.
      EXPECT_LE(cv::norm(mosaic.colour(row, column), cv::Vec3b(60, 120, 180), cv::NORM_INF), 5) << row << ' ' << column;
    }
  }
}

TEST(Orthomosaic, DoesNotDependOnTheNumberOfThreads) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Reconstruction reconstruction = world.reconstruction(folder.path(), 0.1);
  const Orthomosaic one = mosaic_of(world, reconstruction, 1);
  const Orthomosaic three = mosaic_of(world, reconstruction, 3);
  EXPECT_EQ(cv::norm(one.colour, three.colour, cv::NORM_INF), 0);
  EXPECT_EQ(one.residual.median_px, three.residual.median_px);
}

TEST(Orthomosaic, LeavesOutWhatIsSeenAslantOnlyButNoHoles) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Reconstruction reconstruction = world.reconstruction(folder.path());
  const Orthomosaic steep = mosaic_of(world, reconstruction, 1, 15);
  const Orthomosaic wide = mosaic_of(world, reconstruction, 1, 40);
  EXPECT_LT(cv::countNonZero(steep.shown), cv::countNonZero(wide.shown));
  EXPECT_EQ(cv::countNonZero(steep.shown & ~wide.shown), 0);
  // One piece, and one piece around it at most.
  cv::Mat1i regions;
  EXPECT_EQ(cv::connectedComponents(steep.shown, regions), 2);
  const cv::Rect middle(wide.shown.cols / 3, wide.shown.rows / 3, wide.shown.cols / 3, wide.shown.rows / 3);
  EXPECT_EQ(cv::countNonZero(steep.shown(middle) == 0), 0);
}

TEST(Exposure, FindsGainsAndFallOff) {
  // A constant ground under two cameras' worth of known gains and one lens that darkens towards its border.
  MosaicBlocks blocks;
  blocks.grid = grid_over({0, 0}, {40, 40}, 1);
  const std::size_t count = 1600;
  blocks.entries.resize(count * MosaicBlocks::kMaxViews);
  blocks.num_views.assign(count, 2);
  const auto brightness = [](std::size_t view, double radius) {
    return 150 * (1 + 0.1 * static_cast<double>(view)) * (1 - 0.2 * radius * radius);
  };
  for (std::size_t block = 0; block < count; ++block) {
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t view = (static_cast<std::uint32_t>(block) + k) % 3;
      const double radius = static_cast<double>((block * 7 + k * 13) % 31) / 30;
      const auto grey = cv::saturate_cast<unsigned char>(brightness(view, radius));
      blocks.entries[block * MosaicBlocks::kMaxViews + k] = {view, 1.0F, static_cast<float>(radius), {grey, grey, grey}};
    }
  }
  const Exposure exposure = equalise_exposure(blocks, {0, 0, 0}, 1);
  const double wanted = exposure.gain(0, 0, 0)[0] * brightness(0, 0);
  for (std::size_t view = 0; view < 3; ++view) {
    for (double radius = 0; radius <= 1; radius += 0.25) {
      EXPECT_NEAR(exposure.gain(view, 0, radius)[1] * brightness(view, radius) / wanted, 1, 0.01);
    }
  }
}

TEST(DriftFactors, TakeBackWhatGrowsOverManyViewsAndLeaveNeighboursAlone) {
  Exposure exposure;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 40; ++i) {
    places.emplace_back(2.0 * i, 0.0);
    const double drift = 0.03 * (i - 20), own = i % 2 == 0 ? 0.1 : -0.1;
    exposure.log_gain.push_back(cv::Vec3d(drift + own, 0.5 * drift, 0));
  }
  const GroundGrid grid = grid_over({-5, -10}, {85, 10}, 0.5);
  const cv::Mat3f factors = drift_factors(exposure, places, grid, 8.0);
  ASSERT_EQ(factors.size(), cv::Size(grid.columns, grid.rows));
  for (int i = 10; i < 30; ++i) {
    const Eigen::Vector2d at = grid.position_of(places[static_cast<std::size_t>(i)]);
    const cv::Vec3f factor = factors(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x())));
    // A mean over 20 views of +-0.1, and lattice cells of 8.
    EXPECT_NEAR(std::log(factor[0]), -0.03 * (i - 20), 0.02);
    EXPECT_NEAR(std::log(factor[1]), -0.015 * (i - 20), 0.01);
    EXPECT_NEAR(factor[2], 1.0, 1e-5);
  }
}

TEST(DriftFactors, AreOneFarFromAllViews) {
  Exposure exposure;
  exposure.log_gain = {cv::Vec3d(1, 1, 1)};
  const cv::Mat3f factors = drift_factors(exposure, {{0, 0}}, grid_over({1000, 1000}, {1020, 1020}, 1), 1.0);
  EXPECT_EQ(cv::norm(factors, cv::Mat3f(factors.size(), cv::Vec3f(1, 1, 1)), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace fabloop
