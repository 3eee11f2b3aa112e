// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "frontend/error.h"
#include "frontend/fabmap/bootstrap.h"

namespace fabloop {
namespace {

/// Sums of a few hundred numbers of size one.
constexpr double kShareRounding = 1e-12;

std::vector<Decision> random_decisions(std::size_t count, double bias, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Decision> decisions;
  for (std::size_t i = 0; i < count; ++i) {
    const double score = uniform(random);
    decisions.push_back({score, uniform(random) < std::pow(score, bias)});
  }
  return decisions;
}

/// Naeini et al. 2015 as it stands: sum over bins of P(bin) |mean score - share of true ones|, with the bins found by search.
double reference_error(const std::vector<Decision>& decisions, std::size_t num_bins) {
  std::map<std::size_t, std::vector<Decision>> bins;
  for (const Decision& decision : decisions) {
    std::size_t bin = 0;
    while (bin + 1 < num_bins && decision.score >= static_cast<double>(bin + 1) / static_cast<double>(num_bins)) ++bin;
    bins[bin].push_back(decision);
  }
  double error = 0.0;
  for (const auto& [bin, members] : bins) {
    double claimed = 0.0, so = 0.0;
    for (const Decision& decision : members) {
      claimed += decision.score / static_cast<double>(members.size());
      so += (decision.is_true ? 1.0 : 0.0) / static_cast<double>(members.size());
    }
    error += static_cast<double>(members.size()) / static_cast<double>(decisions.size()) * std::abs(claimed - so);
  }
  return error;
}

TEST(Calibration, EqualsTheDefinitionOnRandomDecisions) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto decisions = random_decisions(20 * seed, 1.0 + 0.05 * static_cast<double>(seed), seed);
    const std::size_t num_bins = 1 + seed % 17;
    const Calibration found = calibration(decisions, num_bins);
    EXPECT_NEAR(found.expected_calibration_error, reference_error(decisions, num_bins), kShareRounding);
    double brier = 0.0;
    std::size_t count = 0;
    for (const Decision& decision : decisions) brier += std::pow(decision.score - (decision.is_true ? 1.0 : 0.0), 2);
    for (const ReliabilityBin& bin : found.bins) count += bin.count;
    EXPECT_NEAR(found.brier_score, brier / static_cast<double>(decisions.size()), kShareRounding);
    EXPECT_EQ(count, decisions.size());
  }
}

TEST(Calibration, OfHonestProbabilitiesIsNearZeroAndOfBoastsIsNot) {
  constexpr double kScatter = 0.02;  // ten bins of 2,000: the mean of each is off by 0.01 at most, one sigma
  EXPECT_LT(calibration(random_decisions(20000, 1.0, 7)).expected_calibration_error, kScatter);
  // True with the probability score^3: claimed 1/2 on average, so 1/4.
  EXPECT_NEAR(calibration(random_decisions(20000, 3.0, 7)).expected_calibration_error, 0.25, kScatter);
}

TEST(Calibration, KeepsTheEndsOfTheUnitIntervalAndRefusesWhatIsOutside) {
  const Calibration found = calibration({{0.0, false}, {1.0, true}, {0.1, false}}, 10);
  EXPECT_EQ(found.bins.front().count, 1U);
  EXPECT_EQ(found.bins[1].count, 1U) << "a bin's lower end is its own";
  EXPECT_EQ(found.bins.back().count, 1U) << "one belongs to the last bin";
  EXPECT_THROW(calibration({{1.0001, true}}), InputError);
  EXPECT_THROW(calibration({{std::nan(""), true}}), InputError);
  EXPECT_THROW(calibration({}, 0), InputError);
}

std::vector<std::optional<double>> mean_of(const std::vector<double>& values, std::span<const std::size_t> sample) {
  double sum = 0.0;
  for (const std::size_t i : sample) sum += values[i];
  return {sum / static_cast<double>(sample.size())};
}

TEST(Bootstrap, CoversTheTruthAboutAsOftenAsItSays) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(5.0, 2.0);
  constexpr int kTrials = 200;
  int num_covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values(60);
    for (double& value : values) value = normal(random);
    const auto intervals = bootstrap_intervals(values.size(), [&](auto sample) { return mean_of(values, sample); },
                                               {.num_resamples = 300, .confidence = 0.9});
    ASSERT_TRUE(intervals.at(0).has_value());
    num_covered += intervals[0]->low <= 5.0 && 5.0 <= intervals[0]->high;
  }
  // Binomial(200, 0.9) has a standard deviation of 4.2; the percentile method covers slightly less with 60 values.
  EXPECT_GE(num_covered, 180 - 17);
  EXPECT_LE(num_covered, 180 + 13);
}

TEST(Bootstrap, RepeatsWithItsSeedAndLeavesOutWhatIsSeldomDefined) {
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  const auto figures = [&](std::span<const std::size_t> sample) {
    auto found = mean_of(values, sample);
    found.push_back(std::nullopt);
    return found;
  };
  const auto first = bootstrap_intervals(values.size(), figures), again = bootstrap_intervals(values.size(), figures);
  EXPECT_EQ(first.at(0)->low, again.at(0)->low);
  EXPECT_EQ(first.at(0)->high, again.at(0)->high);
  EXPECT_FALSE(first.at(1).has_value());
  EXPECT_NE(first[0]->low, bootstrap_intervals(values.size(), figures, {.seed = 2}).at(0)->low);
  EXPECT_THROW(bootstrap_intervals(1, figures, {.confidence = 1.0}), InputError);
}

}  // namespace
}  // namespace fabloop
