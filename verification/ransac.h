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

#include "verification/prosac_sampler.h"

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

/// Truncated squared error (MSAC, Torr & Zisserman 2000), in units of the threshold; stops adding once above `bound`.
template <typename Problem>
double msac_cost(const Problem& problem, const typename Problem::Model& model, double max_error_rad, double bound) {
  const auto evaluate = problem.evaluator(model);
  const double inverse_threshold = 1.0 / (max_error_rad * max_error_rad);
  double cost = 0;
  for (std::size_t i = 0; i < problem.size() && cost < bound; ++i) cost += std::min(1.0, evaluate(i) * inverse_threshold);
  return cost;
}

template <typename Problem>
std::vector<std::size_t> inliers_of(const Problem& problem, const typename Problem::Model& model, double max_error_rad) {
  const auto evaluate = problem.evaluator(model);
  std::vector<std::size_t> inliers;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (evaluate(i) < max_error_rad * max_error_rad) inliers.push_back(i);
  }
  return inliers;
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

/// How many samples of a model's inliers alone PROSAC has drawn so far, on average over how it draws: the search may stop once
/// they are -log(1 - confidence), since their number is as good as Poisson distributed. Chum & Matas 2005, section 2.2, with the
/// exact share of good samples of each draw instead of a bound: of a sample of the newest of n data and others before it,
/// (newest is an inlier) * C(inliers before it, size - 1) / C(n - 1, size - 1). Where the order of the data says nothing, that
/// is the usual w^size rule.
template <std::size_t kSize>
class GoodSamples {
 public:
  explicit GoodSamples(std::size_t num_data) : draws_(num_data + 1, 0), p_good_(num_data + 1, 0.0) {}

  void add_draw(std::size_t subset) {
    ++draws_[subset];
    expected_ += p_good_[subset];
  }

  /// Another model to be sure of; `inliers` are ascending.
  void set_inliers(const std::vector<std::size_t>& inliers) {
    const std::size_t num_data = draws_.size() - 1;
    expected_ = 0;
    std::size_t num_before = 0;  // inliers before the newest
    for (std::size_t subset = 1; subset <= num_data; ++subset) {
      const std::size_t newest = subset - 1;
      const bool is_inlier = num_before < inliers.size() && inliers[num_before] == newest;
      if (subset == num_data) {
        p_good_[subset] = share(inliers.size(), num_data, kSize);
      } else {
        p_good_[subset] = is_inlier && subset >= kMinSubset ? share(num_before, newest, kSize - 1) : 0.0;
      }
      expected_ += draws_[subset] * p_good_[subset];
      num_before += is_inlier;
    }
  }

  double expected() const { return expected_; }

 private:
  /// A wrong model's own sample makes too large a share of smaller ones.
  static constexpr std::size_t kMinSubset = 20;

  /// C(good, count) / C(all, count).
  static double share(std::size_t good, std::size_t all, std::size_t count) {
    if (good < count) return 0;
    double share = 1;
    for (std::size_t i = 0; i < count; ++i) share *= static_cast<double>(good - i) / static_cast<double>(all - i);
    return share;
  }

  std::vector<double> draws_;   ///< By the size of the subset.
  std::vector<double> p_good_;  ///< Of one draw, likewise.
  double expected_ = 0;
};

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
    double most = options_.max_iterations;
    if (options_.min_inliers > kSize) {
      most = std::min(most, needed_iterations(options_.min_inliers, problem_.size(), kSize, options_.confidence));
    }
    const double enough = -std::log(1.0 - options_.confidence);
    int iteration = 0;
    for (; iteration < most && good_.expected() < enough; iteration += static_cast<int>(kBatch)) {
      if (!try_samples()) continue;
      optimise_locally();
      good_.set_inliers(best_->inliers);
    }
    if (best_) best_->iterations = iteration;
    return std::move(best_);
  }

 private:
  static constexpr std::size_t kSize = Problem::kSampleSize;
  static constexpr bool kHasCandidates = requires { typename Problem::Candidate; };

  std::array<std::size_t, kSize> draw() {
    const auto sample = sampler_.next();
    good_.add_draw(sampler_.subset());
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
    const double cost = msac_cost(problem_, model, options_.max_error_rad, best_cost_);
    if (cost >= best_cost_) return false;
    best_cost_ = cost;
    best_ = {model, inliers_of(problem_, model, options_.max_error_rad), 0};
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
};

template <typename Problem>
std::optional<RansacResult<typename Problem::Model>> ransac(const Problem& problem, const RansacOptions& options) {
  if (problem.size() < Problem::kSampleSize + 1) return std::nullopt;
  return Ransac<Problem>(problem, options).run();
}

}  // namespace fabloop
