// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/bundle_adjustment.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/residuals/reprojection_cost.h"
#include "tests/posegraph/numeric_derivatives.h"
#include "tests/posegraph/sfm/synthetic_scene.h"

namespace fabloop {
namespace {

using test::make_synthetic_scene;
using test::SyntheticScene;

/// Keypoints are floats: at 640 px they are off by up to 3e-5 px, which is what exactness can mean here.
constexpr double kFloatError = 1e-4;

/// The scene as a bundle whose poses and points are off; the first two views are known.
Bundle perturbed_bundle(const SyntheticScene& scene, double by, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, by);
  const auto vector = [&] { return Eigen::Vector3d(noise(random), noise(random), noise(random)); };
  Bundle bundle;
  bundle.camera = scene.camera;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    Pose pose = scene.world_from_cameras[i];
    if (i >= 2) pose = {pose.rotation * rotation_from_vector(0.02 * vector()), pose.translation + vector()};
    bundle.views.push_back({pose, i < 2, {}});
  }
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    bundle.points_in_world.push_back(scene.points_in_world[t] + vector());
    for (const TrackFeature& member : scene.tracks.tracks[t]) {
      bundle.sightings.push_back({member.view, t, pixel_of(scene.scene(), member)});
    }
  }
  return bundle;
}

double error_of(const SyntheticScene& scene, const AdjustedBundle& adjusted) {
  double squared = 0;
  for (std::size_t i = 0; i < scene.world_from_cameras.size(); ++i) {
    squared += (adjusted.world_from_cameras[i].translation - scene.world_from_cameras[i].translation).squaredNorm();
  }
  return std::sqrt(squared / static_cast<double>(scene.world_from_cameras.size()));
}

constexpr BundleOptions kToTheEnd{.max_iterations = 50, .cost_tolerance = 1e-12};

TEST(BundleAdjustment, FindsTheTruthFromPerturbedStarts) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SyntheticScene scene = make_synthetic_scene({.num_points = 200, .seed = seed});
    const AdjustedBundle adjusted = adjust_bundle(perturbed_bundle(scene, 0.3, seed), kToTheEnd);
    EXPECT_LT(error_of(scene, adjusted), kFloatError);
    EXPECT_LT(adjusted.final_cost, 1e-6 * adjusted.initial_cost);
  }
}

TEST(BundleAdjustment, ErrsInProportionToTheNoise) {
  double small = 0;
  double large = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    for (const double noise_px : {0.1, 0.4}) {
      const SyntheticScene scene = make_synthetic_scene({.num_points = 200, .noise_px = noise_px, .seed = seed});
      (noise_px < 0.2 ? small : large) += error_of(scene, adjust_bundle(perturbed_bundle(scene, 0.1, seed), kToTheEnd));
    }
  }
  // The same draws four times as large; the robust loss makes it a little less linear.
  EXPECT_NEAR(large / small, 4.0, 0.6);
}

TEST(BundleAdjustment, IsHardlyMovedByWrongSightings) {
  const SyntheticScene clean = make_synthetic_scene({.num_points = 300, .noise_px = 0.3, .seed = 5});
  SyntheticScene dirty = make_synthetic_scene({.num_points = 300, .noise_px = 0.3, .seed = 5});
  Bundle bundle = perturbed_bundle(dirty, 0.02, 5);
  for (std::size_t i = 0; i < bundle.sightings.size(); i += 20) bundle.sightings[i].pixel += Eigen::Vector2d(60, -45);
  const double error = error_of(clean, adjust_bundle(perturbed_bundle(clean, 0.02, 5), kToTheEnd));
  EXPECT_LT(error_of(dirty, adjust_bundle(bundle, kToTheEnd)), 3 * error);
}

TEST(BundleAdjustment, HoldsFixedViewsAndFollowsKnownPositions) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 200, .seed = 6});
  Bundle bundle = perturbed_bundle(scene, 0.1, 6);
  const AdjustedBundle held = adjust_bundle(bundle);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(held.world_from_cameras[i].translation, bundle.views[i].world_from_camera.translation);
  }
  // Nothing fixed, but every position known: the whole comes to lie there.
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    bundle.views[i].is_fixed = false;
    bundle.views[i].known_position = scene.world_from_cameras[i].translation + Eigen::Vector3d(5, -3, 2);
    bundle.views[i].position_sigma.setConstant(0.1);
  }
  const AdjustedBundle moved = adjust_bundle(bundle, kToTheEnd);
  for (std::size_t i = 0; i < bundle.views.size(); ++i) {
    EXPECT_LT((moved.world_from_cameras[i].translation - *bundle.views[i].known_position).norm(), 1e-2);
  }
}

TEST(BundleAdjustment, RefinesAFocalLengthAndADistortionThatTheFlightDetermines) {
  const SyntheticScene scene =
      make_synthetic_scene({.num_points = 400, .relief = 8, .tilt_deg = 25, .height_change = 6, .seed = 8});
  Bundle bundle = perturbed_bundle(scene, 0.01, 8);
  for (BundleView& view : bundle.views) view.is_fixed = false;
  bundle.camera.fx *= 1.03;
  bundle.camera.fy *= 1.03;
  bundle.camera.distortion[0] = 0;
  bundle.camera.distortion[1] = 0;
  BundleOptions options = kToTheEnd;
  options.refine = RefineCamera::FocalRadial;
  options.max_iterations = 200;
  const Camera refined = adjust_bundle(bundle, options).camera;
  EXPECT_NEAR(refined.fx, scene.camera.fx, 1e-2);
  EXPECT_NEAR(refined.distortion[0], scene.camera.distortion[0], 1e-4);
  EXPECT_NEAR(refined.distortion[1], scene.camera.distortion[1], 1e-3);
}

TEST(BundleAdjustment, RefusesToRefineAFisheye) {
  Bundle bundle;
  bundle.camera = test::synthetic_camera();
  bundle.camera.distortion_model = DistortionModel::Equidistant;
  EXPECT_THROW(adjust_bundle(bundle, {.refine = RefineCamera::Focal}), InputError);
}

TEST(BundleAdjustment, KnownPositionsMoveAndTurnAWorldThatSightingsAgreeUpon) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 1500, .noise_px = 0.3, .seed = 6});
  const Eigen::Vector3d vague = Eigen::Vector3d::Constant(5);
  // The truth as another world shows it: sightings agree, positions are off by a shift, a turn and a scale.
  const Pose other_from_world{rotation_from_vector({0.01, -0.02, 0.015}), {0.6, -0.8, 0.3}};
  Bundle bundle;
  bundle.camera = scene.camera;
  const auto moved = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return 1.01 * (other_from_world * x); };
  for (const Pose& pose : scene.world_from_cameras) {
    bundle.views.push_back(
        {{other_from_world.rotation * pose.rotation, moved(pose.translation)}, false, pose.translation, vague});
  }
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    bundle.points_in_world.push_back(moved(scene.points_in_world[t]));
    for (const TrackFeature& member : scene.tracks.tracks[t]) {
      bundle.sightings.push_back({member.view, t, pixel_of(scene.scene(), member)});
    }
  }
  // 0.3 px are 0.012 at this height.
  EXPECT_LT(error_of(scene, adjust_bundle(bundle)), 0.03);
}

TEST(BundleAdjustment, IsTheSameInPixelsOfAShrunkImage) {
  constexpr double kTimes = 4;
  const SyntheticScene scene = make_synthetic_scene({.num_points = 150, .noise_px = 1.0, .wrong_share = 0.05, .seed = 5});
  const Bundle small = perturbed_bundle(scene, 0.1, 5);
  Bundle shrunk = small;
  shrunk.camera = scaled(small.camera, kTimes);
  shrunk.pixel_size = kTimes;
  for (BundleSighting& sighting : shrunk.sightings) {
    sighting.pixel = kTimes * (sighting.pixel + Eigen::Vector2d(0.5, 0.5)) - Eigen::Vector2d(0.5, 0.5);
  }
  for (const RefineCamera refine : {RefineCamera::Nothing, RefineCamera::Focal}) {
    BundleOptions options = kToTheEnd;
    options.refine = refine;
    const AdjustedBundle expected = adjust_bundle(small, options);
    const AdjustedBundle found = adjust_bundle(shrunk, options);
    EXPECT_NEAR(found.final_cost, expected.final_cost, 1e-6 * expected.final_cost);
    EXPECT_NEAR(found.camera.fx, kTimes * expected.camera.fx, 1e-3);
    EXPECT_NEAR(error_of(scene, found), error_of(scene, expected), 1e-6);
  }
}

TEST(LensError, IsTheDistanceFromWhereTheCameraProjects) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 50, .seed = 9});
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    const TrackFeature& member = scene.tracks.tracks[t].front();
    const Pose& pose = scene.world_from_cameras[member.view];
    const Eigen::Vector2d pixel(100, 200);
    const Eigen::Vector3d turn(0.1, -0.05, 0.2);
    const bundle::LensError error{scene.camera, pose.rotation * rotation_from_vector(-turn), pixel};
    const std::vector<double> lens{1.0, scene.camera.distortion[0], scene.camera.distortion[1]};
    Eigen::Vector2d residual;
    const Eigen::Vector3d& x = scene.points_in_world[t];
    const std::vector<double> view{
        turn.x(), turn.y(), turn.z(), pose.translation.x(), pose.translation.y(), pose.translation.z()};
    ASSERT_TRUE(error(view.data(), x.data(), lens.data(), residual.data()));
    EXPECT_LT((residual - (*project(scene.camera, pose.inverse() * x) - pixel)).norm(), 1e-9);
  }
}

TEST(BundleAdjustment, HoldsTheUnitOfMovingReadoutsBesideOneFixedView) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 200});
  Bundle bundle = perturbed_bundle(scene, 0.1, 1);
  bundle.views[1].is_fixed = false;
  // They ask for another unit: the sightings are a global shutter's, which a world that is large beside the motions is like.
  for (BundleView& view : bundle.views) view.readout.shift_in_world = {0.3, 0, 0};
  const auto extent = [](const auto& pose_of) {
    double farthest = 0;
    for (std::size_t i = 1; i < 15; ++i) farthest = std::max(farthest, (pose_of(i) - pose_of(0)).norm());
    return farthest;
  };
  const AdjustedBundle adjusted = adjust_bundle(bundle, kToTheEnd);
  const double before = extent([&](std::size_t i) { return bundle.views[i].world_from_camera.translation; });
  const double after = extent([&](std::size_t i) { return adjusted.world_from_cameras[i].translation; });
  constexpr double kUnit = 1e-4;  // of the farthest view itself 1e-6; another may become the farthest
  EXPECT_NEAR(after, before, kUnit * before);
}

TEST(PinholeError, IsTheDistanceFromWhereARollingShutterSees) {
  Camera pinhole = test::synthetic_camera();
  pinhole.distortion.clear();
  const Pose pose{rotation_from_vector({3.0, 0.2, -0.1}), {1, 2, 20}};
  const Eigen::Vector3d x(4, -3, 1);
  const ReadoutMotion readout{{0.001, -0.002, 0.0015}, {0.2, -0.1, 0.05}};
  for (const double share : {-0.5, -0.1, 0.0, 0.4}) {
    const Eigen::Vector2d pixel = *project(pinhole, pose_at_row(pose, readout, share).inverse() * x) + Eigen::Vector2d(0.3, -0.2);
    bundle::TurnedView view(pose.rotation);
    const bundle::PinholeError error(view, pinhole, 2.0, bearings(pinhole, {pixel}).front(), readout, share);
    const bundle::LensError of_lens{pinhole, pose.rotation, pixel, 2.0, readout, share};
    const std::vector<double> block{0, 0, 0, pose.translation.x(), pose.translation.y(), pose.translation.z()};
    const std::vector<double> lens{1, 0, 0};
    Eigen::Vector2d residual;
    ASSERT_TRUE(of_lens(block.data(), x.data(), lens.data(), residual.data()));
    EXPECT_LT((residual - Eigen::Vector2d(-0.15, 0.1)).norm(), 1e-9);
    // The ray is turned in place of the point: alike but for what a small angle stretches at the image's border.
    const double stretch = readout.turn.norm() * residual.norm();
    EXPECT_LT((test::evaluate(error, {block, {x.x(), x.y(), x.z()}}) - residual).norm(), stretch);
    test::expect_derivatives(error, {block, {x.x(), x.y(), x.z()}});
  }
}

TEST(PinholeError, HasTheDerivativesThatDifferencesShow) {
  bundle::TurnedView view(rotation_from_vector({0.1, -0.3, 0.2}));
  const bundle::PinholeError cost(view, 500, 510, Eigen::Vector2d(0.1, -0.2));
  const std::vector<double> point{1.0, 2.0, 8.0};
  for (const double turn : {0.0, 1e-6, 1e-3, 0.5}) {
    test::expect_derivatives(cost, {{turn, -0.3 * turn, 0.2 * turn, 0.3, -0.2, 0.1}, point});
  }
}

TEST(PinholeError, IsTheDistanceFromWhereAPinholeProjects) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 50, .seed = 9});
  Camera pinhole = scene.camera;
  pinhole.distortion.clear();
  const Eigen::Vector3d turn(0.1, -0.05, 0.2);
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    const Pose& pose = scene.world_from_cameras[scene.tracks.tracks[t].front().view];
    bundle::TurnedView view(pose.rotation * rotation_from_vector(-turn));
    const Eigen::Vector2d normalised(0.1, 0.2);
    const bundle::PinholeError error(view, pinhole.fx, pinhole.fy, normalised);
    const std::vector<double> block{
        turn.x(), turn.y(), turn.z(), pose.translation.x(), pose.translation.y(), pose.translation.z()};
    const Eigen::Vector3d& x = scene.points_in_world[t];
    const Eigen::Vector2d pixel(pinhole.fx * normalised.x() + pinhole.cx, pinhole.fy * normalised.y() + pinhole.cy);
    const Eigen::Vector2d expected = *project(pinhole, pose.inverse() * x) - pixel;
    EXPECT_LT((test::evaluate(error, {block, {x.x(), x.y(), x.z()}}) - expected).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace fabloop
