// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/belief.h"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

double log_or_minus_infinity(double p) { return p > 0.0 ? std::log(p) : -std::numeric_limits<double>::infinity(); }

/// exp(x - highest) of each x into `result`; zero where that underflows. Returns their sum.
double exp_of_differences(const std::vector<double>& x, double highest, std::vector<double>& result) {
  constexpr double kUnderflow = -708.0;
  const auto size = static_cast<Eigen::Index>(x.size());
  Eigen::Map<Eigen::ArrayXd> p(result.data(), size);
  // Eigen's is of several numbers at a time, and stops short of zero.
  p = (Eigen::Map<const Eigen::ArrayXd>(x.data(), size) - highest).max(kUnderflow).exp();
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] - highest < kUnderflow ? 0.0 : result[i];
  return p.sum();
}

/// Makes probabilities of logarithms that lack a common factor, `highest` being the highest of them.
void normalize(Belief& belief, double highest) {
  belief.p_place.resize(belief.log_p_place.size());
  belief.p_new = std::exp(belief.log_p_new - highest);
  const double sum = belief.p_new + exp_of_differences(belief.log_p_place, highest, belief.p_place);
  const double log_sum = highest + std::log(sum);
  const double factor = 1.0 / sum;
  belief.p_new *= factor;
  belief.log_p_new -= log_sum;
  for (std::size_t i = 0; i < belief.p_place.size(); ++i) {
    belief.p_place[i] *= factor;
    belief.log_p_place[i] -= log_sum;
  }
}

}  // namespace

Prior uniform_prior(std::size_t num_places, double p_new) {
  assert(p_new >= 0.0 && p_new <= 1.0);
  if (num_places == 0) return {1.0, {}};
  return {p_new, std::vector<double>(num_places, (1.0 - p_new) / static_cast<double>(num_places))};
}

Prior without_recent_places(Prior prior, std::size_t num_places) {
  const std::size_t excluded = std::min(num_places, prior.p_place.size());
  std::fill(prior.p_place.end() - static_cast<std::ptrdiff_t>(excluded), prior.p_place.end(), 0.0);
  double sum = prior.p_new;
  for (const double p : prior.p_place) sum += p;
  // Certainty about an excluded place leaves nothing but the unknown.
  if (!(sum > 0.0)) return {1.0, std::vector<double>(prior.p_place.size(), 0.0)};
  prior.p_new /= sum;
  for (double& p : prior.p_place) p /= sum;
  return prior;
}

Belief without_recent_places(Belief belief, std::size_t num_places) {
  constexpr double kImpossible = -std::numeric_limits<double>::infinity();
  const std::size_t kept = belief.log_p_place.size() - std::min(num_places, belief.log_p_place.size());
  std::fill(belief.log_p_place.begin() + static_cast<std::ptrdiff_t>(kept), belief.log_p_place.end(), kImpossible);
  // From logarithms, since what is left may have underflowed beside what is ruled out.
  double highest = belief.log_p_new;
  for (const double log_p : belief.log_p_place) highest = std::max(highest, log_p);
  if (!std::isfinite(highest)) highest = belief.log_p_new = 0.0;
  normalize(belief, highest);
  return belief;
}

Belief smoothed(Belief belief, double trust) {
  if (!(trust >= 0.0 && trust <= 1.0)) throw InputError("the trust in a belief is " + std::to_string(trust) + "; give 0 to 1");
  if (trust == 1.0) return belief;
  const double share = (1.0 - trust) / static_cast<double>(belief.p_place.size() + 1);
  const auto mix = [&](double& p, double& log_p) {
    p = trust * p + share;
    log_p = std::log(p);
  };
  mix(belief.p_new, belief.log_p_new);
  for (std::size_t i = 0; i < belief.p_place.size(); ++i) mix(belief.p_place[i], belief.log_p_place[i]);
  return belief;
}

Belief posterior(const Prior& prior, std::vector<double> log_likelihood, double log_likelihood_new) {
  const std::size_t num_places = prior.p_place.size();
  if (num_places != log_likelihood.size()) {
    throw InputError("the prior has " + std::to_string(num_places) + " places and the map " +
                     std::to_string(log_likelihood.size()) + "; make the prior for the map as it is now");
  }
  Belief belief;
  belief.log_likelihood_new = log_likelihood_new;
  belief.log_likelihood = std::move(log_likelihood);
  belief.log_p_new = log_or_minus_infinity(prior.p_new) + belief.log_likelihood_new;
  belief.log_p_place = belief.log_likelihood;
  // Most of a map is equally likely beforehand, so that one logarithm serves many places.
  double p_last = 1.0, log_p_last = 0.0;
  for (std::size_t i = 0; i < num_places; ++i) {
    if (prior.p_place[i] != p_last) log_p_last = log_or_minus_infinity(p_last = prior.p_place[i]);
    belief.log_p_place[i] += log_p_last;
  }
  double highest = belief.log_p_new;
  if (num_places > 0) {
    highest = std::max(
        highest, Eigen::Map<const Eigen::ArrayXd>(belief.log_p_place.data(), static_cast<Eigen::Index>(num_places)).maxCoeff());
  }
  if (!std::isfinite(highest)) throw InputError("the observation is impossible at every place that the prior allows");
  normalize(belief, highest);
  return belief;
}

}  // namespace fabloop
