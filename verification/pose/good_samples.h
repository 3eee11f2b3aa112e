// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "verification/evidence.h"
#include "verification/pose/prosac_sampler.h"

namespace fabloop {

/// How many samples of a model's inliers alone PROSAC has drawn so far, on average over how it draws: the search may stop once
/// they are -log(1 - confidence), since their number is as good as Poisson distributed. Chum & Matas 2005, section 2.2, with the
/// exact share of good samples of each draw instead of a bound: of a sample of the newest of n data and others before it,
/// (newest is an inlier) * C(inliers before it, size - 1) / C(n - 1, size - 1). Where the order of the data says nothing, that
/// is the usual w^size rule.
template <std::size_t kSize>
class GoodSamples {
 public:
  explicit GoodSamples(std::size_t num_data) : of_growth_(num_data + 1), of_subsets_(num_data + 1), richest_(num_data) {}

  void add_draw(ProsacDraw draw) {
    Draws& draws = draw.has_newest ? of_growth_[draw.subset] : of_subsets_[draw.subset];
    ++draws.count;
    expected_ += draws.p_good;
  }

  /// Another model to be sure of; `inliers` are ascending. An accidental datum agrees with it with the probability `p_accident`.
  void set_inliers(const std::vector<std::size_t>& inliers, double p_accident) {
    const std::size_t num_data = of_growth_.size() - 1;
    expected_ = 0;
    richest_ = num_data;
    std::size_t num_before = 0;  // inliers before the newest
    for (std::size_t subset = 1; subset <= num_data; ++subset) {
      const std::size_t newest = subset - 1;
      const bool is_inlier = num_before < inliers.size() && inliers[num_before] == newest;
      const bool counts = subset >= kMinSubset || subset == num_data;
      of_growth_[subset].p_good = counts && is_inlier ? share(num_before, newest, kSize - 1) : 0.0;
      num_before += is_inlier;
      of_subsets_[subset].p_good = counts ? share(num_before, subset, kSize) : 0.0;
      for (const Draws& draws : {of_growth_[subset], of_subsets_[subset]}) expected_ += draws.count * draws.p_good;
    }
    choose_richest(inliers, p_accident);
  }

  double expected() const { return expected_; }

  /// Of how many of the first data samples are good most often: Chum & Matas' n*. Only such first data count whose inliers are
  /// no accident, since the data of a wrong model's sample, and what agrees with them by luck, come early too.
  std::size_t richest() const { return richest_; }

 private:
  struct Draws {
    double count = 0;
    double p_good = 0;  ///< Of one.
  };

  /// A wrong model's own sample makes too large a share of smaller ones.
  static constexpr std::size_t kMinSubset = 20;

  void choose_richest(const std::vector<std::size_t>& inliers, double p_accident) {
    constexpr double kMostModels = 10;
    constexpr double kMaxLog10FalseAlarms = -2;
    std::vector<std::size_t> richer;  // than all data, by the inlier that ends them: the share falls until the next one
    for (std::size_t i = kSize; i < inliers.size(); ++i) {
      if (inliers[i] + 1 >= kMinSubset && p_good_of(inliers[i]) > of_subsets_.back().p_good) richer.push_back(i);
    }
    std::stable_sort(richer.begin(), richer.end(),
                     [&](std::size_t a, std::size_t b) { return p_good_of(inliers[a]) > p_good_of(inliers[b]); });
    const auto proven = std::find_if(richer.begin(), richer.end(), [&](std::size_t i) {
      return log10_false_alarms(inliers[i] + 1, i + 1, kSize, p_accident, kMostModels) < kMaxLog10FalseAlarms;
    });
    if (proven != richer.end()) richest_ = inliers[*proven] + 1;
  }

  /// Of a sample of the data up to the last one given.
  double p_good_of(std::size_t last) const { return of_subsets_[last + 1].p_good; }

  /// C(good, count) / C(all, count).
  static double share(std::size_t good, std::size_t all, std::size_t count) {
    if (good < count) return 0;
    double share = 1;
    for (std::size_t i = 0; i < count; ++i) share *= static_cast<double>(good - i) / static_cast<double>(all - i);
    return share;
  }

  std::vector<Draws> of_growth_;   ///< By the size of the subset, with its newest datum.
  std::vector<Draws> of_subsets_;  ///< Likewise, of any of its data.
  double expected_ = 0;
  std::size_t richest_;
};

}  // namespace fabloop
