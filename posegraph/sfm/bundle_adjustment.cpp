// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/bundle_adjustment.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "frontend/error.h"
#include "posegraph/sfm/reprojection_cost.h"

namespace fabloop {
namespace {

/// Below this many views the reduced system is dense anyway.
constexpr std::size_t kMaxDenseViews = 120;

class Adjustment {
 public:
  Adjustment(const Bundle& bundle, const BundleOptions& options)
      : bundle_(bundle), options_(options), points_(bundle.points_in_world), loss_(options.loss_px) {
    for (const BundleView& view : bundle.views) {
      rotations_.push_back(view.world_from_camera.rotation.normalized());
      centres_.push_back(view.world_from_camera.translation);
    }
    const auto& k = bundle.camera.distortion;
    lens_ = {1.0, k.empty() ? 0.0 : k[0], k.size() > 1 ? k[1] : 0.0};
  }

  AdjustedBundle run() {
    add_sightings();
    add_positions();
    hold_what_is_fixed();
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem_, &summary);
    AdjustedBundle result{refined_camera(), {}, points_, summary.initial_cost, summary.final_cost,
                          static_cast<int>(summary.iterations.size())};
    for (std::size_t i = 0; i < rotations_.size(); ++i) result.world_from_cameras.push_back({rotations_[i], centres_[i]});
    return result;
  }

 private:
  bool refines() const { return options_.refine != RefineCamera::Nothing; }

  void add_sightings() {
    std::vector<Eigen::Vector2d> pixels;
    for (const BundleSighting& sighting : bundle_.sightings) pixels.push_back(sighting.pixel);
    const std::vector<Eigen::Vector3d> rays = bearings(bundle_.camera, pixels);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const BundleSighting& sighting = bundle_.sightings[i];
      double* const rotation = rotations_[sighting.view].coeffs().data();
      double* const centre = centres_[sighting.view].data();
      double* const point = points_[sighting.point].data();
      if (refines()) {
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<bundle::LensError, 2, 4, 3, 3, 3>(
                                      new bundle::LensError{bundle_.camera, sighting.pixel}),
                                  &loss_, rotation, centre, point, lens_.data());
      } else {
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<bundle::PinholeError, 2, 4, 3, 3>(new bundle::PinholeError{
                bundle_.camera.fx, bundle_.camera.fy, rays[i].head<2>() / rays[i].z()}),
            &loss_, rotation, centre, point);
      }
    }
  }

  void add_positions() {
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      const BundleView& view = bundle_.views[i];
      if (!view.known_position || !problem_.HasParameterBlock(centres_[i].data())) continue;
      has_positions_ = true;
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<bundle::PositionError, 3, 3>(
                                    new bundle::PositionError{*view.known_position, view.position_sigma}),
                                &position_loss_, centres_[i].data());
    }
  }

  void hold_what_is_fixed() {
    const bool none_fixed = std::none_of(bundle_.views.begin(), bundle_.views.end(), [](const auto& v) { return v.is_fixed; });
    bool hold_next = none_fixed && !has_positions_;
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      double* const rotation = rotations_[i].coeffs().data();
      if (!problem_.HasParameterBlock(rotation)) continue;
      problem_.SetManifold(rotation, &quaternion_);
      if (!bundle_.views[i].is_fixed && !hold_next) continue;
      hold_next = false;
      problem_.SetParameterBlockConstant(rotation);
      problem_.SetParameterBlockConstant(centres_[i].data());
    }
    if (options_.refine == RefineCamera::Focal && problem_.HasParameterBlock(lens_.data())) {
      problem_.SetManifold(lens_.data(), &focal_only_);
    }
  }

  ceres::Solver::Options solver_options() {
    ceres::Solver::Options result;
    result.linear_solver_type = bundle_.views.size() > kMaxDenseViews ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
    result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    result.num_threads = 1;
    result.max_num_iterations = options_.max_iterations;
    result.function_tolerance = options_.cost_tolerance;
    result.logging_type = ceres::SILENT;
    auto* ordering = new ceres::ParameterBlockOrdering;
    for (auto& point : points_) {
      if (problem_.HasParameterBlock(point.data())) ordering->AddElementToGroup(point.data(), 0);
    }
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      for (double* block : {rotations_[i].coeffs().data(), centres_[i].data()}) {
        if (problem_.HasParameterBlock(block)) ordering->AddElementToGroup(block, 1);
      }
    }
    if (problem_.HasParameterBlock(lens_.data())) ordering->AddElementToGroup(lens_.data(), 1);
    result.linear_solver_ordering.reset(ordering);
    return result;
  }

  Camera refined_camera() const {
    Camera camera = bundle_.camera;
    if (!refines()) return camera;
    camera.fx *= lens_[0];
    camera.fy *= lens_[0];
    if (options_.refine == RefineCamera::FocalRadial) {
      if (camera.distortion.size() < 4) camera.distortion.resize(4, 0.0);
      camera.distortion[0] = lens_[1];
      camera.distortion[1] = lens_[2];
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
  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> centres_, points_;
  std::array<double, 3> lens_{};
  bool has_positions_ = false;
  ceres::CauchyLoss loss_;
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
