// SPDX-License-Identifier: BSD-3-Clause
//
// Two views of 200 matches, 0.5 px of noise, threshold 1.5 px, confidence 0.999, one thread: ours beside OpenGV's own loop over
// the same five points. A success is a rotation within 1 degree and a direction within 5.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/relative_pose/CentralRelativePoseSacProblem.hpp>
#include <optional>
#include <vector>

#include "tests/verification/two_view_world.h"
#include "verification/pose/planar_ambiguity.h"
#include "verification/pose/pose_choice.h"
#include "verification/pose/relative_pose.h"
#include "verification/verifier.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViewOptions;
using testing_support::TwoViews;

constexpr std::size_t kNumTrials = 1000;
constexpr double kFocalPx = 500;  // of test_camera()
constexpr double kMaxErrorRad = 1.5 / kFocalPx;

std::vector<TwoViews> make_worlds(TwoViewOptions options) {
  options.noise_px = 0.5;
  std::vector<TwoViews> worlds;
  for (std::size_t trial = 0; trial < kNumTrials; ++trial) {
    options.seed = trial + 1;
    worlds.push_back(make_two_views(options));
  }
  return worlds;
}

class Tally {
 public:
  void add(const std::optional<Pose>& found, const Pose& truth, int draws) {
    ++count_;
    draws_ += draws;
    const double rotation_deg = found ? deg_from_rad(found->rotation.angularDistance(truth.rotation)) : 180.0;
    const double direction_deg = found ? deg_from_rad(angle_between(found->translation, truth.translation)) : 180.0;
    rotations_deg_.push_back(rotation_deg);
    num_right_ += rotation_deg < 1.0 && direction_deg < 5.0;
  }

  void report(benchmark::State& state) {
    const auto middle = rotations_deg_.begin() + static_cast<std::ptrdiff_t>(rotations_deg_.size() / 2);
    std::nth_element(rotations_deg_.begin(), middle, rotations_deg_.end());
    state.counters["success_percent"] = 100.0 * num_right_ / count_;
    state.counters["median_rotation_deg"] = *middle;
    state.counters["draws"] = draws_ / count_;
  }

 private:
  double num_right_ = 0, count_ = 0, draws_ = 0;
  std::vector<double> rotations_deg_;
};

RelativePoseOptions options_of_trial(std::size_t trial) {
  return {.max_error_rad = kMaxErrorRad, .confidence = 0.999, .max_iterations = 100000, .seed = trial};
}

void estimate(benchmark::State& state, const std::vector<TwoViews>& worlds, FivePointSolver solver) {
  Tally tally;
  std::size_t trial = 0;
  for (auto _ : state) {
    const TwoViews& world = worlds[trial % kNumTrials];
    RelativePoseOptions options = options_of_trial(trial++);
    options.solver = solver;
    const auto found = estimate_relative_pose(world.pairs, options);
    tally.add(found ? std::optional(found->match_from_query) : std::nullopt, world.match_from_query,
              found ? found->iterations : 0);
  }
  tally.report(state);
}

double share(const benchmark::State& state) { return 0.01 * static_cast<double>(state.range(0)); }

void ours(benchmark::State& state) { estimate(state, make_worlds({.outlier_ratio = share(state)}), FivePointSolver::Lanes); }

void ours_with_opengvs_solver(benchmark::State& state) {
  estimate(state, make_worlds({.outlier_ratio = share(state)}), FivePointSolver::OpenGv);
}

void ours_scored(benchmark::State& state) {
  estimate(state, make_worlds({.outlier_ratio = share(state), .scored = true}), FivePointSolver::Lanes);
}

/// Points all over the image, in which nearly all of a real one's features lie too.
void ours_filling(benchmark::State& state) {
  estimate(state, make_worlds({.outlier_ratio = share(state), .fills_image = true}), FivePointSolver::Lanes);
}

void ours_filling_scored(benchmark::State& state) {
  estimate(state, make_worlds({.outlier_ratio = share(state), .fills_image = true, .scored = true}), FivePointSolver::Lanes);
}

void opengvs(benchmark::State& state) {
  using Problem = opengv::sac_problems::relative_pose::CentralRelativePoseSacProblem;
  const std::vector<TwoViews> worlds = make_worlds({.outlier_ratio = share(state)});
  Tally tally;
  std::size_t trial = 0;
  for (auto _ : state) {
    const TwoViews& world = worlds[trial++ % kNumTrials];
    opengv::bearingVectors_t match_rays, query_rays;
    for (const RayPair& pair : world.pairs) {
      match_rays.push_back(pair.match);
      query_rays.push_back(pair.query);
    }
    opengv::relative_pose::CentralRelativeAdapter adapter(match_rays, query_rays);
    constexpr int kMaxDraws = 1000;  // its own default; more do not find more in a tolerable time
    opengv::sac::Ransac<Problem> loop(kMaxDraws, 1.0 - std::cos(kMaxErrorRad), 0.999);
    loop.sac_model_ = std::make_shared<Problem>(adapter, Problem::NISTER, false);
    std::optional<Pose> found;
    if (loop.computeModel()) {
      Problem::model_t refined;
      loop.sac_model_->optimizeModelCoefficients(loop.inliers_, loop.model_coefficients_, refined);
      found = Pose{Eigen::Quaterniond(Eigen::Matrix3d(refined.leftCols<3>())), refined.col(3)};
    }
    tally.add(found, world.match_from_query, loop.iterations_);
  }
  tally.report(state);
}

/// A plane has two poses; odometry that knows the rotation to 10 degrees and the direction to 20 tells them apart.
void ours_planar(benchmark::State& state) {
  const std::vector<TwoViews> worlds = make_worlds({.outlier_ratio = share(state), .planar = true});
  Tally tally;
  std::size_t trial = 0;
  for (auto _ : state) {
    const TwoViews& world = worlds[trial % kNumTrials];
    const RelativePoseOptions options = options_of_trial(trial++);
    std::vector<Match> matches(world.pairs.size());
    for (std::size_t i = 0; i < matches.size(); ++i) matches[i] = {static_cast<int>(i), static_cast<int>(i), 0};
    PosePrior prior{world.match_from_query};
    const double direction_sigma = rad_from_deg(20) * world.match_from_query.translation.norm();
    prior.covariance.topLeftCorner<3, 3>() *= direction_sigma * direction_sigma;
    prior.covariance.bottomRightCorner<3, 3>() *= rad_from_deg(10) * rad_from_deg(10);
    auto found = estimate_relative_pose(world.pairs, options);
    std::optional<Pose> chosen;
    const int draws = found ? found->iterations : 0;
    if (found) {
      chosen = choose_pose(world.query, world.match, matches, world.pairs, std::move(*found), {options, {}, {}}, prior)
                   .chosen.relative.match_from_query;
    }
    tally.add(chosen, world.match_from_query, draws);
  }
  tally.report(state);
}

void at_outlier_percents(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("outlier_percent")->Arg(30)->Arg(50)->Arg(70)->Iterations(kNumTrials)->Unit(benchmark::kMillisecond);
}
BENCHMARK(ours)->Name("RelativePose")->Apply(at_outlier_percents);
BENCHMARK(ours_scored)
    ->Name("RelativePoseScored")
    ->ArgName("outlier_percent")
    ->Arg(85)
    ->Iterations(kNumTrials)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(ours_filling)->Name("RelativePoseFillingImage")->Apply(at_outlier_percents);
BENCHMARK(ours_filling_scored)
    ->Name("RelativePoseFillingImageScored")
    ->ArgName("outlier_percent")
    ->Arg(85)
    ->Iterations(kNumTrials)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(ours_planar)
    ->Name("RelativePosePlanar")
    ->ArgName("outlier_percent")
    ->Arg(50)
    ->Iterations(kNumTrials)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(ours_with_opengvs_solver)
    ->Name("RelativePoseByOpenGvSolver")
    ->ArgName("outlier_percent")
    ->Arg(30)
    ->Arg(50)
    ->Iterations(kNumTrials)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(opengvs)
    ->Name("RelativePoseOpenGvLoop")
    ->ArgName("outlier_percent")
    ->Arg(30)
    ->Arg(50)
    ->Arg(70)
    ->Iterations(kNumTrials / 10)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
