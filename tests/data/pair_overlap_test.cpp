// SPDX-License-Identifier: BSD-3-Clause
#include "data/pair_overlap.h"

#include <gtest/gtest.h>

#include "data/flight_plan.h"
#include "data/world_writer.h"

namespace fabloop {
namespace {

HeightMap flat_ground() {
  HeightMap map;
  map.origin = {-100, -100};
  map.spacing_m = 10;
  map.heights.create(21, 21);
  map.heights.setTo(0.0F);
  update_block_max(map);
  return map;
}

Pose above(double x, double y, double height_m) {
  return {Eigen::Quaterniond(0, 1, 0, 0), {x, y, height_m}};  // x east, y south, z down
}

Camera square_camera() { return {100, 100, 100, 100, 49.5, 49.5, DistortionModel::Radtan, {}}; }

TEST(PairOverlap, FootprintIsWhatThePinholeSees) {
  const Footprint footprint = ground_footprint(flat_ground(), square_camera(), above(3, 4, 20));
  ASSERT_EQ(footprint.size(), 4U);
  EXPECT_NEAR(area_of(footprint), 400, 0.1);  // 100 px at 100 px focal length from 20 m: 20 m a side
}

TEST(PairOverlap, IsOneForTheSamePoseAndForAViewInsideAnother) {
  const HeightMap ground = flat_ground();
  const Footprint here = ground_footprint(ground, square_camera(), above(0, 0, 20));
  EXPECT_NEAR(overlap(here, here), 1, 1e-9);
  EXPECT_NEAR(overlap(here, ground_footprint(ground, square_camera(), above(1, 1, 10))), 1, 1e-6);
}

TEST(PairOverlap, IsHalfAfterHalfAFootprintAndNothingAfterAWhole) {
  const HeightMap ground = flat_ground();
  const Footprint here = ground_footprint(ground, square_camera(), above(0, 0, 20));
  EXPECT_NEAR(overlap(here, ground_footprint(ground, square_camera(), above(10, 0, 20))), 0.5, 1e-3);
  EXPECT_NEAR(overlap(here, ground_footprint(ground, square_camera(), above(20.1, 0, 20))), 0, 1e-9);
  EXPECT_EQ(overlap(here, {}), 0);
}

TEST(PairOverlap, IsSymmetric) {
  FlightOptions options;
  options.length_m = 100;
  const auto poses = plan_flight(options);
  const HeightMap ground = flat_ground();
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    const Footprint a = ground_footprint(ground, synthetic_camera(), poses[i]);
    const Footprint b = ground_footprint(ground, synthetic_camera(), poses[poses.size() - 1 - i]);
    EXPECT_NEAR(overlap(a, b), overlap(b, a), 1e-9);
    EXPECT_NEAR(overlap(a, a), 1, 1e-9);
  }
}

TEST(PairOverlap, ListsPairsBeyondTheGapInOrder) {
  const std::vector<Pose> poses = {above(0, 0, 20), above(5, 0, 20), above(90, 0, 20), above(0, 0, 20), above(8, 0, 20)};
  const auto pairs = overlapping_pairs(flat_ground(), square_camera(), poses, 2, 0.05);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].i, 0U);
  EXPECT_EQ(pairs[0].j, 3U);
  EXPECT_NEAR(pairs[0].overlap, 1, 1e-9);
  EXPECT_NEAR(pairs[1].distance_m, 8, 1e-9);
  EXPECT_EQ(pairs[2].i, 1U);
}

}  // namespace
}  // namespace fabloop
