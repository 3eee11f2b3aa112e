// SPDX-License-Identifier: BSD-3-Clause
//
// Poses from 200 points, 0.5 px of noise, threshold 1.5 px, confidence 0.999: ours beside OpenGV's own loop over the same solver.
#include <benchmark/benchmark.h>

#include <cmath>
#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/absolute_pose/AbsolutePoseSacProblem.hpp>
#include <optional>
#include <vector>

#include "tests/bench/pose_tally.h"
#include "tests/verification/absolute_pose_world.h"
#include "verification/pose/absolute_pose.h"

namespace fabloop {
namespace {

using testing_support::AbsolutePoseWorld;
using testing_support::kFocalPx;
using testing_support::make_absolute_pose_world;
using testing_support::PoseTally;

constexpr std::size_t kNumTrials = 1000;
constexpr double kMaxErrorRad = 1.5 / kFocalPx;
constexpr double kConfidence = 0.999;
constexpr int kMaxIterations = 10000;
constexpr double kMedianDepth = 8;  // of the synthetic points

std::vector<AbsolutePoseWorld> make_worlds(const benchmark::State& state) {
  std::vector<AbsolutePoseWorld> worlds;
  for (std::size_t seed = 0; seed < kNumTrials; ++seed) {
    worlds.push_back(make_absolute_pose_world(
        {.outlier_ratio = 0.01 * static_cast<double>(state.range(0)), .noise_px = 0.5, .seed = seed + 1}));
  }
  return worlds;
}

void ours(benchmark::State& state) {
  const std::vector<AbsolutePoseWorld> worlds = make_worlds(state);
  PoseTally tally(kMedianDepth);
  std::size_t trial = 0;
  for (auto _ : state) {
    const AbsolutePoseWorld& world = worlds[trial % kNumTrials];
    const auto found = estimate_absolute_pose(
        world.data,
        {.max_error_rad = kMaxErrorRad, .confidence = kConfidence, .max_iterations = kMaxIterations, .seed = trial++});
    tally.add(found ? std::optional(found->world_from_camera) : std::nullopt, world.world_from_camera,
              found ? found->iterations : kMaxIterations);
  }
  tally.report(state);
}

void opengvs(benchmark::State& state) {
  using Problem = opengv::sac_problems::absolute_pose::AbsolutePoseSacProblem;
  const std::vector<AbsolutePoseWorld> worlds = make_worlds(state);
  PoseTally tally(kMedianDepth);
  std::size_t trial = 0;
  for (auto _ : state) {
    const AbsolutePoseWorld& world = worlds[trial++ % kNumTrials];
    opengv::bearingVectors_t rays;
    opengv::points_t points;
    for (const PointRay& datum : world.data) {
      rays.push_back(datum.ray_in_camera);
      points.push_back(datum.point_in_world);
    }
    opengv::absolute_pose::CentralAbsoluteAdapter adapter(rays, points);
    opengv::sac::Ransac<Problem> loop(kMaxIterations, 1.0 - std::cos(kMaxErrorRad), kConfidence);
    loop.sac_model_ = std::make_shared<Problem>(adapter, Problem::KNEIP, false);
    std::optional<Pose> found;
    if (loop.computeModel()) {
      Problem::model_t refined;
      loop.sac_model_->optimizeModelCoefficients(loop.inliers_, loop.model_coefficients_, refined);
      found = Pose{Eigen::Quaterniond(Eigen::Matrix3d(refined.leftCols<3>())), refined.col(3)};
    }
    tally.add(found, world.world_from_camera, loop.iterations_);
  }
  tally.report(state);
}

void at_outlier_percents(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("outlier_percent")->Arg(30)->Arg(50)->Arg(70)->Iterations(kNumTrials)->Unit(benchmark::kMicrosecond);
}
BENCHMARK(ours)->Name("AbsolutePose")->Apply(at_outlier_percents);
BENCHMARK(opengvs)->Name("AbsolutePoseOpenGvLoop")->Apply(at_outlier_percents);

}  // namespace
}  // namespace fabloop
