// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "verification/pose/ransac.h"

namespace fabloop {

/// Locally optimised RANSAC (Chum, Matas & Kittler 2003) over a problem that draws its own samples, because they have structure:
/// five data of one pair of cameras and a sixth of another, say. Its models are rough, so that the best of them says little about
/// the best after refinement: the best of every eight draws is refined, not only one that is the best so far.
///
/// A Problem has `Model`, `size()`, `evaluator(model) -> (index -> squared error in radians)`, `propose(random) -> models`,
/// `p_good_sample(inliers) -> probability that propose() draws inliers alone`, `refine(model) -> model`.
template <typename Problem>
std::optional<RansacResult<typename Problem::Model>> sampled_ransac(const Problem& problem, const RansacOptions& options) {
  using Model = typename Problem::Model;
  constexpr int kBatch = 8;
  constexpr int kMaxLocalRounds = 4;
  std::mt19937_64 random(options.seed);
  std::optional<RansacResult<Model>> best;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Model& model) {
    const auto evaluate = problem.evaluator(model);
    const double cost = truncated_cost(problem.size(), evaluate, options.max_error_rad, best_cost);
    if (cost >= best_cost) return false;
    best_cost = cost;
    best = {model, agreeing(problem.size(), evaluate, options.max_error_rad), 0};
    return true;
  };
  double needed = options.max_iterations;
  int iteration = 0;
  while (iteration < needed) {
    std::optional<Model> best_of_batch;
    double cost_of_batch = static_cast<double>(problem.size());
    for (const int end = iteration + kBatch; iteration < end && iteration < needed; ++iteration) {
      for (const Model& model : problem.propose(random)) {
        const double cost = msac_cost(problem, model, options.max_error_rad, cost_of_batch);
        if (cost >= cost_of_batch) continue;
        cost_of_batch = cost;
        best_of_batch = model;
      }
    }
    if (!best_of_batch) continue;
    bool improved = consider(*best_of_batch);
    improved |= consider(problem.refine(*best_of_batch));
    if (!improved) continue;
    for (int round = 0; round < kMaxLocalRounds; ++round) {
      if (!consider(problem.refine(best->model))) break;
    }
    needed = std::min(static_cast<double>(options.max_iterations),
                      needed_draws(problem.p_good_sample(best->inliers), options.confidence));
  }
  if (best) best->iterations = iteration;
  return best;
}

}  // namespace fabloop
