// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "verification/pose/good_samples.h"
#include "verification/pose/prosac_sampler.h"

namespace fabloop {

/// How long to look for a model, and what agrees with it.
struct RansacOptions {
  double max_error_rad = 0;   ///< Residual up to which a datum agrees with a model. A pixel threshold over the focal length.
  double confidence = 0.999;  ///< Probability of having drawn one sample without outliers before stopping.
  int max_iterations = 1500;  ///< Bounds the time spent on data without a model.
  std::uint64_t seed = 0;
  std::size_t min_inliers = 0;  ///< Models with fewer are of no use: the search ends once one with so many would have shown.
};

template <typename Model>
struct RansacResult {
  Model model;
  std::vector<std::size_t> inliers;  ///< Ascending.
  int iterations = 0;
};

/// Truncated squared error (MSAC, Torr & Zisserman 2000) of `num_data` data, in units of the threshold; stops adding once above
/// `bound`. `evaluate(index)` is a datum's squared error in radians.
template <typename Evaluate>
double truncated_cost(std::size_t num_data, const Evaluate& evaluate, double max_error_rad, double bound) {
  const double inverse_threshold = 1.0 / (max_error_rad * max_error_rad);
  double cost = 0;
  for (std::size_t i = 0; i < num_data && cost < bound; ++i) cost += std::min(1.0, evaluate(i) * inverse_threshold);
  return cost;
}

template <typename Evaluate>
std::vector<std::size_t> agreeing(std::size_t num_data, const Evaluate& evaluate, double max_error_rad) {
  std::vector<std::size_t> inliers;
  for (std::size_t i = 0; i < num_data; ++i) {
    if (evaluate(i) < max_error_rad * max_error_rad) inliers.push_back(i);
  }
  return inliers;
}

/// truncated_cost() of a problem's data about a model.
template <typename Problem>
double msac_cost(const Problem& problem, const typename Problem::Model& model, double max_error_rad, double bound) {
  return truncated_cost(problem.size(), problem.evaluator(model), max_error_rad, bound);
}

template <typename Problem>
std::vector<std::size_t> inliers_of(const Problem& problem, const typename Problem::Model& model, double max_error_rad) {
  return agreeing(problem.size(), problem.evaluator(model), max_error_rad);
}

/// Draws until one success in a row of attempts with the given probability is as sure as `confidence`.
inline double needed_draws(double p_good, double confidence) {
  if (p_good >= 1.0) return 0;
  if (p_good <= 0.0) return std::numeric_limits<double>::infinity();
  return std::log(1.0 - confidence) / std::log1p(-p_good);
}

/// Draws needed until one of `sample_size` inliers has been drawn with the wanted confidence.
inline double needed_iterations(std::size_t num_inliers, std::size_t num_data, std::size_t sample_size, double confidence) {
  const double share = static_cast<double>(num_inliers) / static_cast<double>(num_data);
  return needed_draws(std::pow(share, static_cast<double>(sample_size)), confidence);
}

/// The probability that a datum which has nothing to do with a model agrees with it: as many lie between one and two thresholds,
/// where nearly none of the true ones is. Residuals of several axes make it larger than it is, never smaller.
template <typename Evaluate>
double p_accident(std::size_t num_data, const Evaluate& evaluate, double max_error_rad) {
  const double squared = max_error_rad * max_error_rad;
  std::size_t num_beyond = 0;
  for (std::size_t i = 0; i < num_data; ++i) {
    const double error = evaluate(i);
    num_beyond += error >= squared && error < 4.0 * squared;
  }
  return std::min(1.0, static_cast<double>(num_beyond + 1) / static_cast<double>(num_data));
}

/// What a minimal solver returns: `Problem::Candidate` where that is cheaper than a model, else the model itself.
template <typename Problem>
struct CandidateOf {
  using Type = typename Problem::Model;
  static constexpr std::size_t kBatchSize = 1;
};
template <typename Problem>
requires requires { typename Problem::Candidate; }
struct CandidateOf<Problem> {
  using Type = typename Problem::Candidate;
  static constexpr std::size_t kBatchSize = Problem::kBatchSize;
};

/// Locally optimised RANSAC (Chum, Matas & Kittler 2003) over data sorted by quality. A Problem has: `Model`, `kSampleSize`,
/// `size()`, `solve(sample) -> models`, `evaluator(model) -> (index -> squared error in radians)`, `refine(model, inliers) ->
/// model`.
///
/// One whose solver takes several samples at once, or whose models are dear to make, has instead of solve(): `Candidate`,
/// `kBatchSize`, `solve(samples) -> candidates`, `cost(candidate, bound)` as msac_cost(), and `model_of(candidate) ->
/// optional model`.
template <typename Problem>
class Ransac {
 public:
  using Model = typename Problem::Model;

  Ransac(const Problem& problem, const RansacOptions& options)
      : problem_(problem),
        options_(options),
        sampler_(problem.size(), options.max_iterations, options.seed),
        good_(problem.size()) {}

  std::optional<RansacResult<Model>> run() {
    constexpr std::size_t kBatch = CandidateOf<Problem>::kBatchSize;
    // Draws from the best model's own data find no other model, so they do not count.
    const double most_elsewhere = options_.min_inliers > kSize
                                      ? needed_iterations(options_.min_inliers, problem_.size(), kSize, options_.confidence)
                                      : std::numeric_limits<double>::infinity();
    const double enough = -std::log(1.0 - options_.confidence);
    int iteration = 0;
    for (; iteration < options_.max_iterations && sampler_.num_in_order() < most_elsewhere && good_.expected() < enough;
         iteration += static_cast<int>(kBatch)) {
      if (!try_samples()) continue;
      optimise_locally();
      good_.set_inliers(best_->inliers, p_accident_);
      sampler_.set_rich(good_.richest());
    }
    if (best_) best_->iterations = iteration;
    return std::move(best_);
  }

 private:
  static constexpr std::size_t kSize = Problem::kSampleSize;
  static constexpr bool kHasCandidates = requires { typename Problem::Candidate; };

  std::array<std::size_t, kSize> draw() {
    const auto sample = sampler_.next();
    good_.add_draw(sampler_.draw());
    return sample;
  }

  /// Whether one of the next samples' models is the best so far.
  bool try_samples() {
    bool improved = false;
    if constexpr (kHasCandidates) {
      std::array<std::array<std::size_t, kSize>, Problem::kBatchSize> samples;
      for (auto& sample : samples) sample = draw();
      for (const auto& candidate : problem_.solve(samples)) {
        if (problem_.cost(candidate, best_cost_) >= best_cost_) continue;
        const auto model = problem_.model_of(candidate);
        improved |= model && consider(*model);
      }
    } else {
      for (const Model& model : problem_.solve(draw())) improved |= consider(model);
    }
    return improved;
  }

  bool consider(const Model& model) {
    const auto evaluate = problem_.evaluator(model);
    const double cost = truncated_cost(problem_.size(), evaluate, options_.max_error_rad, best_cost_);
    if (cost >= best_cost_) return false;
    best_cost_ = cost;
    best_ = {model, agreeing(problem_.size(), evaluate, options_.max_error_rad), 0};
    p_accident_ = p_accident(problem_.size(), evaluate, options_.max_error_rad);
    return true;
  }

  void optimise_locally() {
    constexpr int kMaxRounds = 4;
    for (int round = 0; round < kMaxRounds && best_->inliers.size() > kSize; ++round) {
      if (!consider(problem_.refine(best_->model, best_->inliers))) break;
    }
  }

  const Problem& problem_;
  const RansacOptions& options_;
  ProsacSampler<kSize> sampler_;
  GoodSamples<kSize> good_;
  std::optional<RansacResult<Model>> best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  double p_accident_ = 1;
};

template <typename Problem>
std::optional<RansacResult<typename Problem::Model>> ransac(const Problem& problem, const RansacOptions& options) {
  if (problem.size() < Problem::kSampleSize + 1) return std::nullopt;
  return Ransac<Problem>(problem, options).run();
}

}  // namespace fabloop
