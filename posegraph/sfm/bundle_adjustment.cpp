// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/bundle_adjustment.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "frontend/error.h"
#include "posegraph/sfm/reprojection_cost.h"

namespace fabloop {
namespace {

/// Below this many views the reduced system is dense anyway.
constexpr std::size_t kMaxDenseViews = 120;

class Adjustment {
 public:
  Adjustment(const Bundle& bundle, const BundleOptions& options)
      : bundle_(bundle),
        options_(options),
        loss_(options.loss_px),
        blocks_(kLensSize + kViewSize * bundle.views.size() + 3 * bundle.points_in_world.size()) {
    const auto& k = bundle.camera.distortion;
    lens()[0] = 1.0;
    lens()[1] = k.empty() ? 0.0 : k[0];
    lens()[2] = k.size() > 1 ? k[1] : 0.0;
    for (std::size_t i = 0; i < bundle.views.size(); ++i) {
      Eigen::Map<Eigen::Vector4d>(rotation(i)) = bundle.views[i].world_from_camera.rotation.normalized().coeffs();
      Eigen::Map<Eigen::Vector3d>(centre(i)) = bundle.views[i].world_from_camera.translation;
    }
    for (std::size_t i = 0; i < bundle.points_in_world.size(); ++i) {
      Eigen::Map<Eigen::Vector3d>(point(i)) = bundle.points_in_world[i];
    }
  }

  AdjustedBundle run() {
    add_sightings();
    add_positions();
    hold_what_is_fixed();
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem_, &summary);
    AdjustedBundle result{
        refined_camera(), {}, {}, summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size())};
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      result.world_from_cameras.push_back(
          {Eigen::Quaterniond(Eigen::Map<Eigen::Vector4d>(rotation(i))).normalized(), Eigen::Map<Eigen::Vector3d>(centre(i))});
    }
    for (std::size_t i = 0; i < bundle_.points_in_world.size(); ++i) {
      result.points_in_world.emplace_back(Eigen::Map<Eigen::Vector3d>(point(i)));
    }
    return result;
  }

 private:
  static constexpr std::size_t kLensSize = 3;
  static constexpr std::size_t kViewSize = 7;

  double* lens() { return blocks_.data(); }
  double* rotation(std::size_t view) { return blocks_.data() + kLensSize + kViewSize * view; }
  double* centre(std::size_t view) { return rotation(view) + 4; }
  double* point(std::size_t i) { return blocks_.data() + kLensSize + kViewSize * bundle_.views.size() + 3 * i; }
  bool refines() const { return options_.refine != RefineCamera::Nothing; }

  void add_sightings() {
    std::vector<Eigen::Vector2d> pixels;
    for (const BundleSighting& sighting : bundle_.sightings) pixels.push_back(sighting.pixel);
    const std::vector<Eigen::Vector3d> rays = bearings(bundle_.camera, pixels);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const BundleSighting& sighting = bundle_.sightings[i];
      if (refines()) {
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<bundle::LensError, 2, 4, 3, 3, 3>(
                                      new bundle::LensError{bundle_.camera, sighting.pixel}),
                                  &loss_, rotation(sighting.view), centre(sighting.view), point(sighting.point), lens());
      } else {
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<bundle::PinholeError, 2, 4, 3, 3>(new bundle::PinholeError{
                                      bundle_.camera.fx, bundle_.camera.fy, rays[i].head<2>() / rays[i].z()}),
                                  &loss_, rotation(sighting.view), centre(sighting.view), point(sighting.point));
      }
    }
  }

  void add_positions() {
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      const BundleView& view = bundle_.views[i];
      if (!view.known_position || !problem_.HasParameterBlock(centre(i))) continue;
      has_positions_ = true;
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<bundle::PositionError, 3, 3>(
                                    new bundle::PositionError{*view.known_position, view.position_sigma}),
                                &position_loss_, centre(i));
    }
  }

  void hold_what_is_fixed() {
    const bool none_fixed = std::none_of(bundle_.views.begin(), bundle_.views.end(), [](const auto& v) { return v.is_fixed; });
    bool hold_next = none_fixed && !has_positions_;
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      if (!problem_.HasParameterBlock(rotation(i))) continue;
      problem_.SetManifold(rotation(i), &quaternion_);
      if (!bundle_.views[i].is_fixed && !hold_next) continue;
      hold_next = false;
      problem_.SetParameterBlockConstant(rotation(i));
      problem_.SetParameterBlockConstant(centre(i));
    }
    if (options_.refine == RefineCamera::Focal && problem_.HasParameterBlock(lens())) problem_.SetManifold(lens(), &focal_only_);
  }

  ceres::Solver::Options solver_options() {
    ceres::Solver::Options result;
    result.linear_solver_type = bundle_.views.size() > kMaxDenseViews ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
    result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    result.num_threads = 1;
    result.max_num_iterations = options_.max_iterations;
    result.function_tolerance = options_.cost_tolerance;
    result.logging_type = ceres::SILENT;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    const auto add = [&](double* block, int group) {
      if (problem_.HasParameterBlock(block)) ordering->AddElementToGroup(block, group);
    };
    for (std::size_t i = 0; i < bundle_.points_in_world.size(); ++i) add(point(i), 0);
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      add(rotation(i), 1);
      add(centre(i), 1);
    }
    add(lens(), 1);
    result.linear_solver_ordering = ordering;
    return result;
  }

  Camera refined_camera() {
    Camera camera = bundle_.camera;
    if (!refines()) return camera;
    camera.fx *= lens()[0];
    camera.fy *= lens()[0];
    if (options_.refine == RefineCamera::FocalRadial) {
      if (camera.distortion.size() < 4) camera.distortion.resize(4, 0.0);
      camera.distortion[0] = lens()[1];
      camera.distortion[1] = lens()[2];
    }
    return camera;
  }

  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  const Bundle& bundle_;
  const BundleOptions& options_;
  ceres::CauchyLoss loss_;
  /// The lens, the views, the points. Ceres orders blocks by their addresses: in one array these do not change from run to run.
  std::vector<double> blocks_;
  bool has_positions_ = false;
  ceres::CauchyLoss position_loss_{2.0};
  ceres::EigenQuaternionManifold quaternion_;
  ceres::SubsetManifold focal_only_{3, {1, 2}};
  ceres::Problem problem_{problem_options()};
};

}  // namespace

AdjustedBundle adjust_bundle(const Bundle& bundle, const BundleOptions& options) {
  if (options.refine != RefineCamera::Nothing && bundle.camera.distortion_model != DistortionModel::Radtan) {
    throw InputError("only cameras of the plumb-bob model can be refined; keep this calibration as it is");
  }
  return Adjustment(bundle, options).run();
}

double reprojection_error_px(const Camera& camera, const Pose& world_from_camera, const Eigen::Vector3d& x_in_world,
                             const Eigen::Vector2d& pixel) {
  const auto projected = project(camera, world_from_camera.inverse() * x_in_world);
  return projected ? (*projected - pixel).norm() : std::numeric_limits<double>::infinity();
}

}  // namespace fabloop
