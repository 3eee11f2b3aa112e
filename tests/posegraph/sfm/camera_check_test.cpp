// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/camera_check.h"

#include <gtest/gtest.h>

#include "posegraph/sfm/track_triangulation.h"
#include "tests/posegraph/sfm/synthetic_scene.h"

namespace fabloop {
namespace {

using test::make_synthetic_scene;
using test::SyntheticScene;

/// The true segment as the given focal length sees it.
CameraCheck check(SyntheticScene scene, double given_over_true) {
  scene.camera.fx *= given_over_true;
  scene.camera.fy *= given_over_true;
  for (View& view : scene.views) view = make_view(view.frame, scene.camera, std::move(view.features));
  Segment segment = empty_segment(scene.scene());
  for (std::size_t i = 0; i < scene.views.size(); ++i) segment.world_from_cameras[i] = scene.world_from_cameras[i];
  constexpr double kAllPx = 500;  // a wrong focal length throws the sightings far off before the adjustment
  refresh_all_points(scene.scene(), segment, {.max_error_px = kAllPx, .num_threads = 1});
  // The errors here are independent, unlike those of real neighbours: less caution than by default is right.
  return check_camera(scene.scene(), segment, {.redundancy = 10});
}

TEST(CameraCheck, FindsAFocalLengthThatIsAFifthOff) {
  const SyntheticScene scene =
      make_synthetic_scene({.num_points = 200, .relief = 8, .tilt_deg = 20, .height_change = 5, .noise_px = 0.3, .seed = 1});
  const CameraCheck right = check(scene, 1.0);
  EXPECT_TRUE(right.is_determined);
  EXPECT_FALSE(right.is_contradicted);
  EXPECT_NEAR(right.best_focal_factor, 1.0, 4 * right.relative_sigma + 1e-3);
  const CameraCheck wrong = check(scene, 1.2);
  EXPECT_TRUE(wrong.is_contradicted);
  EXPECT_NEAR(wrong.best_focal_factor, 1.0 / 1.2, 0.03);
}

TEST(CameraCheck, DoesNotTrustWhatAFlightAtOneHeightOverFlatGroundShows) {
  const CameraCheck flat = check(
      make_synthetic_scene({.num_points = 200, .relief = 0, .tilt_deg = 0, .height_change = 0, .noise_px = 0.3, .seed = 2}), 1.0);
  EXPECT_FALSE(flat.is_determined);
  EXPECT_FALSE(flat.is_contradicted);
}

}  // namespace
}  // namespace fabloop
