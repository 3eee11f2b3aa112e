// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace fabloop {

/// How long to look for a model, and what agrees with it.
struct RansacOptions {
  double max_error_rad = 0;   ///< Residual up to which a datum agrees with a model. A pixel threshold over the focal length.
  double confidence = 0.999;  ///< Probability of having drawn one sample without outliers before stopping.
  int max_iterations = 1500;  ///< Bounds the time spent on data without a model.
  std::uint64_t seed = 0;
};

template <typename Model>
struct RansacResult {
  Model model;
  std::vector<std::size_t> inliers;  ///< Ascending.
  int iterations = 0;
};

/// Draws samples from the best data first and from all of them later: PROSAC (Chum & Matas, CVPR 2005), which assumes data
/// sorted by quality, best first.
template <std::size_t kSize>
class ProsacSampler {
 public:
  ProsacSampler(std::size_t num_data, int max_iterations, std::uint64_t seed)
      : num_data_(num_data), subset_(kSize), draws_(max_iterations), random_(seed) {
    for (std::size_t i = 0; i < kSize; ++i) draws_ *= static_cast<double>(kSize - i) / static_cast<double>(num_data - i);
  }

  std::array<std::size_t, kSize> next() {
    ++iteration_;
    if (iteration_ > static_cast<double>(grow_at_) && subset_ < num_data_) {  // eq. 3 and 4
      const double more = draws_ * static_cast<double>(subset_ + 1) / static_cast<double>(subset_ + 1 - kSize);
      grow_at_ += static_cast<std::int64_t>(std::ceil(more - draws_));
      draws_ = more;
      ++subset_;
    }
    std::array<std::size_t, kSize> sample{};
    const bool with_newest = subset_ < num_data_;  // the newest datum and others before it
    const std::size_t count = with_newest ? kSize - 1 : kSize;
    for (std::size_t i = 0; i < count;) {
      sample[i] = uniform(with_newest ? subset_ - 1 : subset_);
      if (std::find(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(i), sample[i]) ==
          sample.begin() + static_cast<std::ptrdiff_t>(i)) {
        ++i;
      }
    }
    if (with_newest) sample[kSize - 1] = subset_ - 1;
    return sample;
  }

 private:
  /// In [0, bound). The standard's distributions differ between libraries; this one is the same everywhere.
  std::size_t uniform(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }

  std::size_t num_data_;
  std::size_t subset_;
  double draws_;
  std::int64_t grow_at_ = 1;
  double iteration_ = 0;
  std::mt19937_64 random_;
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

/// Draws needed until one of `sample_size` inliers has been drawn with the wanted confidence.
inline double needed_iterations(std::size_t num_inliers, std::size_t num_data, std::size_t sample_size, double confidence) {
  const double p_good =
      std::pow(static_cast<double>(num_inliers) / static_cast<double>(num_data), static_cast<double>(sample_size));
  if (p_good >= 1.0) return 0;
  if (p_good <= 0.0) return std::numeric_limits<double>::infinity();
  return std::log(1.0 - confidence) / std::log1p(-p_good);
}

/// Locally optimised RANSAC (Chum, Matas & Kittler 2003) over data sorted by quality. A Problem has: `Model`, `kSampleSize`,
/// `size()`, `solve(sample) -> models`, `evaluator(model) -> (index -> squared error in radians)`, `refine(model, inliers) ->
/// model`.
template <typename Problem>
std::optional<RansacResult<typename Problem::Model>> ransac(const Problem& problem, const RansacOptions& options) {
  constexpr std::size_t kSize = Problem::kSampleSize;
  if (problem.size() < kSize + 1) return std::nullopt;
  ProsacSampler<kSize> sampler(problem.size(), options.max_iterations, options.seed);
  std::optional<RansacResult<typename Problem::Model>> best;
  double best_cost = std::numeric_limits<double>::infinity();
  double needed = options.max_iterations;
  const auto consider = [&](const typename Problem::Model& model) {
    const double cost = msac_cost(problem, model, options.max_error_rad, best_cost);
    if (cost >= best_cost) return false;
    best_cost = cost;
    best = {model, inliers_of(problem, model, options.max_error_rad), 0};
    return true;
  };
  int iteration = 0;
  for (; iteration < needed; ++iteration) {
    bool improved = false;
    for (const auto& model : problem.solve(sampler.next())) improved |= consider(model);
    if (!improved) continue;
    constexpr int kMaxLocalRounds = 4;
    for (int round = 0; round < kMaxLocalRounds && best->inliers.size() > kSize; ++round) {
      if (!consider(problem.refine(best->model, best->inliers))) break;
    }
    needed = std::min(static_cast<double>(options.max_iterations),
                      needed_iterations(best->inliers.size(), problem.size(), kSize, options.confidence));
  }
  if (best) best->iterations = iteration;
  return best;
}

}  // namespace fabloop
