// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/bundle_adjustment.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "frontend/error.h"
#include "posegraph/residuals/reprojection_cost.h"

namespace fabloop {
namespace {

/// Below this many views that move the reduced system is dense anyway.
constexpr std::ptrdiff_t kMaxDenseViews = 120;

using bundle::TurnedView;
using LensCost = ceres::AutoDiffCostFunction<bundle::LensError, 2, bundle::kViewSize, 3, 3>;
using DistanceCost = ceres::AutoDiffCostFunction<bundle::DistanceError, 1, bundle::kViewSize>;
using PositionCost = ceres::AutoDiffCostFunction<bundle::PositionError, 3, bundle::kViewSize>;

class Adjustment {
 public:
  Adjustment(const Bundle& bundle, const BundleOptions& options)
      : bundle_(bundle),
        options_(options),
        loss_(options.loss_px),
        blocks_(kLensSize + kViewSize * bundle.views.size() + kPointSize * bundle.points_in_world.size()) {
    const auto& k = bundle.camera.distortion;
    lens()[0] = 1.0;
    lens()[1] = k.empty() ? 0.0 : k[0];
    lens()[2] = k.size() > 1 ? k[1] : 0.0;
    for (std::size_t i = 0; i < bundle.views.size(); ++i) {
      turned_.emplace_back(bundle.views[i].world_from_camera.rotation.normalized());
      Eigen::Map<Eigen::Vector3d>(view(i) + 3) = bundle.views[i].world_from_camera.translation;
    }
    for (std::size_t i = 0; i < bundle.points_in_world.size(); ++i) {
      Eigen::Map<Eigen::Vector3d>(point(i)) = bundle.points_in_world[i];
    }
  }

  AdjustedBundle run() {
    add_sightings();
    add_positions();
    hold_what_is_fixed();
    hold_unit();
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem_, &summary);
    AdjustedBundle result{
        refined_camera(), {}, {}, summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size())};
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      const Eigen::Quaterniond turn = rotation_from_vector(Eigen::Map<Eigen::Vector3d>(view(i)));
      result.world_from_cameras.push_back({(turned_[i].start() * turn).normalized(), Eigen::Map<Eigen::Vector3d>(view(i) + 3)});
    }
    for (std::size_t i = 0; i < bundle_.points_in_world.size(); ++i) {
      result.points_in_world.emplace_back(Eigen::Map<Eigen::Vector3d>(point(i)));
    }
    return result;
  }

 private:
  static constexpr std::size_t kLensSize = 3, kViewSize = bundle::kViewSize, kPointSize = 3;

  double* lens() { return blocks_.data(); }
  double* view(std::size_t i) { return blocks_.data() + kLensSize + kViewSize * i; }
  double* point(std::size_t i) { return view(bundle_.views.size()) + kPointSize * i; }
  bool refines() const { return options_.refine != RefineCamera::Nothing; }

  void add_sightings() {
    std::vector<Eigen::Vector2d> pixels;
    for (const BundleSighting& sighting : bundle_.sightings) pixels.push_back(sighting.pixel);
    const std::vector<Eigen::Vector3d> rays = bearings(bundle_.camera, pixels);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const BundleSighting& sighting = bundle_.sightings[i];
      TurnedView& turned = turned_[sighting.view];
      const double share = readout_share(bundle_.camera, sighting.pixel.y());
      const ReadoutMotion& readout = bundle_.views[sighting.view].readout;
      if (refines()) {
        lens_errors_.push_back(std::make_unique<LensCost>(
            new bundle::LensError{bundle_.camera, turned.start(), sighting.pixel, bundle_.pixel_size, readout, share}));
        problem_.AddResidualBlock(lens_errors_.back().get(), &loss_, view(sighting.view), point(sighting.point), lens());
      } else {
        pinhole_errors_.emplace_back(turned, bundle_.camera, bundle_.pixel_size, rays[i], readout, share);
        problem_.AddResidualBlock(&pinhole_errors_.back(), &loss_, view(sighting.view), point(sighting.point));
      }
    }
  }

  void add_positions() {
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      const BundleView& given = bundle_.views[i];
      if (!given.known_position || !problem_.HasParameterBlock(view(i))) continue;
      has_positions_ = true;
      position_errors_.push_back(
          std::make_unique<PositionCost>(new bundle::PositionError{*given.known_position, given.position_sigma}));
      problem_.AddResidualBlock(position_errors_.back().get(), &position_loss_, view(i));
    }
  }

  void hold_what_is_fixed() {
    const bool none_fixed = std::none_of(bundle_.views.begin(), bundle_.views.end(), [](const auto& v) { return v.is_fixed; });
    bool hold_next = none_fixed && !has_positions_;
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) {
      if (!problem_.HasParameterBlock(view(i))) continue;
      if (bundle_.views[i].is_fixed || hold_next) problem_.SetParameterBlockConstant(view(i));
      hold_next = false;
    }
    if (options_.refine == RefineCamera::Focal && problem_.HasParameterBlock(lens())) problem_.SetManifold(lens(), &focal_only_);
  }

  /// Readout motions are lengths that do not follow the world's unit: where nothing else holds it, as two held views do, it would
  /// shrink or grow until they fit better.
  void hold_unit() {
    constexpr double kRelativeSigma = 1e-6;
    const auto& views = bundle_.views;
    const bool none_moves =
        std::all_of(views.begin(), views.end(), [](const auto& v) { return v.readout.shift_in_world.isZero(0); });
    if (none_moves || has_positions_) return;
    std::vector<std::size_t> held, moving;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!problem_.HasParameterBlock(view(i))) continue;
      (problem_.IsParameterBlockConstant(view(i)) ? held : moving).push_back(i);
    }
    if (held.size() != 1 || moving.empty()) return;
    const Eigen::Vector3d& centre = views[held.front()].world_from_camera.translation;
    const auto distance = [&](std::size_t i) { return (views[i].world_from_camera.translation - centre).norm(); };
    const std::size_t farthest =
        *std::max_element(moving.begin(), moving.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    if (!(distance(farthest) > 0)) return;
    distance_error_ = std::make_unique<DistanceCost>(new bundle::DistanceError{centre, distance(farthest), kRelativeSigma});
    problem_.AddResidualBlock(distance_error_.get(), nullptr, view(farthest));
  }

  ceres::Solver::Options solver_options() {
    ceres::Solver::Options result;
    const auto num_moving =
        std::count_if(bundle_.views.begin(), bundle_.views.end(), [](const BundleView& v) { return !v.is_fixed; });
    result.linear_solver_type = num_moving > kMaxDenseViews ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
    result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    result.num_threads = 1;
    result.max_num_iterations = options_.max_iterations;
    result.function_tolerance = options_.cost_tolerance;
    if (has_positions_) {
      // They hold what sightings leave free: the whole world and slow bends. Beside thousands of sightings these cost next to
      // nothing, and damping by the sightings' curvature, or an end at a small share of their cost, would keep them where they
      // are.
      constexpr double kUndamped = 1e10, kShareOfTolerance = 1e-4;
      result.initial_trust_region_radius = kUndamped;
      result.function_tolerance *= kShareOfTolerance;
    }
    result.logging_type = ceres::SILENT;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    const auto add = [&](double* block, int group) {
      if (problem_.HasParameterBlock(block)) ordering->AddElementToGroup(block, group);
    };
    for (std::size_t i = 0; i < bundle_.points_in_world.size(); ++i) add(point(i), 0);
    for (std::size_t i = 0; i < bundle_.views.size(); ++i) add(view(i), 1);
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
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  const Bundle& bundle_;
  const BundleOptions& options_;
  ceres::CauchyLoss loss_;
  /// The lens, the views, the points. Ceres orders blocks by their addresses: in one array these do not change from run to run.
  std::vector<double> blocks_;
  std::vector<TurnedView> turned_;                   ///< One a view.
  std::deque<bundle::PinholeError> pinhole_errors_;  ///< Cannot be moved.
  std::vector<std::unique_ptr<LensCost>> lens_errors_;
  std::vector<std::unique_ptr<PositionCost>> position_errors_;
  std::unique_ptr<DistanceCost> distance_error_;
  bool has_positions_ = false;
  ceres::CauchyLoss position_loss_{2.0};
  ceres::SubsetManifold focal_only_{3, {1, 2}};
  ceres::Problem problem_{problem_options()};
};

}  // namespace

void require_refinable(const Camera& camera) {
  if (camera.distortion_model == DistortionModel::Radtan) return;
  throw InputError("only cameras of the plumb-bob model can be refined; keep this calibration as it is");
}

AdjustedBundle adjust_bundle(const Bundle& bundle, const BundleOptions& options) {
  if (options.refine != RefineCamera::Nothing) require_refinable(bundle.camera);
  return Adjustment(bundle, options).run();
}

double reprojection_error_px(const Camera& camera, const Pose& world_from_camera, const Eigen::Vector3d& x_in_world,
                             const Eigen::Vector2d& pixel) {
  const auto projected = project(camera, world_from_camera.inverse() * x_in_world);
  return projected ? (*projected - pixel).norm() : std::numeric_limits<double>::infinity();
}

}  // namespace fabloop
