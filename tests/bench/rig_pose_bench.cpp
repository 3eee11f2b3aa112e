// SPDX-License-Identifier: BSD-3-Clause
//
// A rig of four cameras among 200 pairs or points, noise of 0.5 px and threshold 1.5 px at 500 px, confidence 0.999: ours beside
// OpenGV's own loops over the same solvers, all of them stopped after 1500 draws.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <opengv/absolute_pose/NoncentralAbsoluteAdapter.hpp>
#include <opengv/relative_pose/NoncentralRelativeAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/absolute_pose/AbsolutePoseSacProblem.hpp>
#include <opengv/sac_problems/relative_pose/NoncentralRelativePoseSacProblem.hpp>
#include <optional>
#include <vector>

#include "tests/bench/pose_tally.h"
#include "tests/verification/rig_world.h"
#include "verification/rig/rig_pose.h"

namespace fabloop {
namespace {

using opengv::sac_problems::absolute_pose::AbsolutePoseSacProblem;
using opengv::sac_problems::relative_pose::NoncentralRelativePoseSacProblem;
using testing_support::make_rig_world;
using testing_support::PoseTally;
using testing_support::RigWorld;

constexpr std::size_t kNumTrials = 100;
constexpr double kNoiseRad = 0.001;
constexpr double kMaxErrorRad = 3 * kNoiseRad;
constexpr double kConfidence = 0.999;
constexpr int kMaxIterations = 1500;
constexpr double kBaseline = 1.5;

std::vector<RigWorld> make_worlds(const benchmark::State& state) {
  std::vector<RigWorld> worlds;
  for (std::size_t seed = 1; seed <= kNumTrials; ++seed) {
    worlds.push_back(make_rig_world({.baseline = kBaseline,
                                     .outlier_ratio = 0.01 * static_cast<double>(state.range(0)),
                                     .noise_rad = kNoiseRad,
                                     .seed = seed}));
  }
  return worlds;
}

void relative(benchmark::State& state, RigSolver solver) {
  const std::vector<RigWorld> worlds = make_worlds(state);
  PoseTally tally(kBaseline);
  std::size_t trial = 0;
  for (auto _ : state) {
    const RigWorld& world = worlds[trial % kNumTrials];
    const auto found = estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad,
                                                                .confidence = kConfidence,
                                                                .max_iterations = kMaxIterations,
                                                                .solver = solver,
                                                                .seed = trial++});
    tally.add(found ? std::optional(found->match_from_query) : std::nullopt, world.match_from_query,
              found ? found->iterations : kMaxIterations);
  }
  tally.report(state);
}

void absolute(benchmark::State& state) {
  const std::vector<RigWorld> worlds = make_worlds(state);
  PoseTally tally(kBaseline);
  std::size_t trial = 0;
  for (auto _ : state) {
    const RigWorld& world = worlds[trial % kNumTrials];
    const auto found = estimate_rig_absolute_pose(
        world.points_and_rays,
        {.max_error_rad = kMaxErrorRad, .confidence = kConfidence, .max_iterations = kMaxIterations, .seed = trial++});
    tally.add(found ? std::optional(found->world_from_body) : std::nullopt, world.match_from_query,
              found ? found->iterations : kMaxIterations);
  }
  tally.report(state);
}

/// Rays as OpenGV wants them, each a camera of its own.
struct OpenGvRays {
  opengv::bearingVectors_t rays;
  std::vector<int> cameras;

  void add(const RigRay& ray, opengv::translations_t& offsets, opengv::rotations_t& rotations) {
    rays.push_back(ray.ray_in_body);
    cameras.push_back(static_cast<int>(offsets.size()));
    offsets.push_back(ray.origin_in_body);
    rotations.push_back(opengv::rotation_t::Identity());
  }
};

template <typename Problem>
void run_opengv(const std::shared_ptr<Problem>& problem, double threshold, const Pose& truth, PoseTally& tally) {
  opengv::sac::Ransac<Problem> loop(kMaxIterations, threshold, kConfidence);
  loop.sac_model_ = problem;
  std::optional<Pose> found;
  if (loop.computeModel()) {
    opengv::transformation_t refined;
    problem->optimizeModelCoefficients(loop.inliers_, loop.model_coefficients_, refined);
    found = Pose{Eigen::Quaterniond(Eigen::Matrix3d(refined.leftCols<3>())), refined.col(3)};
  }
  tally.add(found, truth, loop.iterations_);
}

void opengvs_relative(benchmark::State& state, NoncentralRelativePoseSacProblem::algorithm_t algorithm) {
  const std::vector<RigWorld> worlds = make_worlds(state);
  PoseTally tally(kBaseline);
  std::size_t trial = 0;
  for (auto _ : state) {
    const RigWorld& world = worlds[trial++ % kNumTrials];
    OpenGvRays match, query;
    opengv::translations_t offsets;
    opengv::rotations_t rotations;
    for (const RigRayPair& pair : world.pairs) {
      match.add(pair.match, offsets, rotations);
      query.add(pair.query, offsets, rotations);
    }
    opengv::relative_pose::NoncentralRelativeAdapter adapter(match.rays, query.rays, match.cameras, query.cameras, offsets,
                                                             rotations);
    run_opengv(std::make_shared<NoncentralRelativePoseSacProblem>(adapter, algorithm, false, false),
               2.0 * (1.0 - std::cos(kMaxErrorRad)), world.match_from_query, tally);
  }
  tally.report(state);
}

void opengvs_absolute(benchmark::State& state) {
  const std::vector<RigWorld> worlds = make_worlds(state);
  PoseTally tally(kBaseline);
  std::size_t trial = 0;
  for (auto _ : state) {
    const RigWorld& world = worlds[trial++ % kNumTrials];
    OpenGvRays rays;
    opengv::points_t points;
    opengv::translations_t offsets;
    opengv::rotations_t rotations;
    for (const RigPointRay& datum : world.points_and_rays) {
      rays.add(datum.ray, offsets, rotations);
      points.push_back(datum.point_in_world);
    }
    opengv::absolute_pose::NoncentralAbsoluteAdapter adapter(rays.rays, rays.cameras, points, offsets, rotations);
    run_opengv(std::make_shared<AbsolutePoseSacProblem>(adapter, AbsolutePoseSacProblem::GP3P, false),
               1.0 - std::cos(kMaxErrorRad), world.match_from_query, tally);
  }
  tally.report(state);
}

void at_outlier_percents(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("outlier_percent")->Arg(0)->Arg(30)->Arg(50)->Iterations(kNumTrials)->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(relative, FivePlusOne, RigSolver::FivePlusOne)->Apply(at_outlier_percents);
BENCHMARK_CAPTURE(relative, GeneralisedEigen, RigSolver::GeneralisedEigen)->Apply(at_outlier_percents);
BENCHMARK_CAPTURE(relative, SeventeenPoint, RigSolver::SeventeenPoint)->Apply(at_outlier_percents);
BENCHMARK_CAPTURE(opengvs_relative, GeneralisedEigen, NoncentralRelativePoseSacProblem::GE)->Apply(at_outlier_percents);
BENCHMARK_CAPTURE(opengvs_relative, SeventeenPoint, NoncentralRelativePoseSacProblem::SEVENTEENPT)->Apply(at_outlier_percents);
BENCHMARK(absolute)->Name("RigAbsolutePose")->Apply(at_outlier_percents);
BENCHMARK(opengvs_absolute)->Name("RigAbsolutePoseOpenGvLoop")->Apply(at_outlier_percents);

}  // namespace
}  // namespace fabloop
