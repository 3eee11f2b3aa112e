// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/point_error.h"

#include <gtest/gtest.h>

#include "tests/posegraph/sfm/synthetic_scene.h"

namespace fabloop {
namespace {

using test::SyntheticScene;

/// The true map of a scene, in another world and unit where `scale` and `world_from_scene` say so.
Reconstruction map_of(const SyntheticScene& scene, double scale = 1, const Pose& world_from_scene = {}) {
  const auto moved = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return scale * (world_from_scene.rotation * x) + world_from_scene.translation;
  };
  Reconstruction map;
  map.cameras = {scene.camera};
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    const Pose& pose = scene.world_from_cameras[i];
    const auto time_ns = static_cast<std::int64_t>(i) * 1'000'000'000;
    map.images.push_back({i, {}, time_ns, 0, {world_from_scene.rotation * pose.rotation, moved(pose.translation)}});
  }
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    ScenePoint point;
    point.x_in_world = moved(scene.points_in_world[t]);
    for (const TrackFeature& member : scene.tracks.tracks[t])
      point.track.push_back({member.view, pixel_of(scene.scene(), member)});
    map.points.push_back(point);
  }
  return map;
}

constexpr TrajectoryErrorOptions kSim3{.alignment = Alignment::Sim3};

TEST(PointError, OfATrueMapIsNoneWhateverItsWorldAndUnit) {
  const SyntheticScene scene = test::make_synthetic_scene({.num_points = 200});
  const Trajectory reference = trajectory_of(map_of(scene));
  const auto error = point_error(map_of(scene, 3.0, {rotation_from_vector({0.4, 1.0, -2.0}), {5, 6, 7}}), reference, kSim3);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->across_m.count, scene.points_in_world.size());
  EXPECT_LT(error->across_m.max, 1e-3);
  EXPECT_LT(error->height_m.max, 1e-3);
}

TEST(PointError, TellsApartWhatLiesAcrossAndInHeight) {
  const SyntheticScene scene = test::make_synthetic_scene({.num_points = 200});
  Reconstruction map = map_of(scene);
  const Trajectory reference = trajectory_of(map);
  for (ScenePoint& point : map.points) point.x_in_world += Eigen::Vector3d(0.3, 0.4, -0.2);
  const auto error = point_error(map, reference, kSim3);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->across_m.median, 0.5, 1e-3);
  EXPECT_NEAR(error->height_m.median, 0.2, 1e-3);
}

TEST(PointError, AsksOnlyImagesThatTheReferenceKnows) {
  const SyntheticScene scene = test::make_synthetic_scene({.num_points = 200});
  const Reconstruction map = map_of(scene);
  Trajectory some = trajectory_of(map);
  some.resize(5);
  const auto of_all = point_error(map, trajectory_of(map), kSim3);
  const auto of_some = point_error(map, some, kSim3);
  ASSERT_TRUE(of_all && of_some);
  EXPECT_LT(of_some->across_m.count, of_all->across_m.count);
  some.resize(2);
  EXPECT_FALSE(point_error(map, some, kSim3));
}

}  // namespace
}  // namespace fabloop
