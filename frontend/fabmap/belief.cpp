// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/belief.h"

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

Belief posterior(const Prior& prior, std::vector<double> log_likelihood, double log_likelihood_new) {
  if (prior.p_place.size() != log_likelihood.size()) {
    throw InputError("the prior has " + std::to_string(prior.p_place.size()) + " places and the map " +
                     std::to_string(log_likelihood.size()) + "; make the prior for the map as it is now");
  }
  Belief belief;
  belief.log_likelihood_new = log_likelihood_new;
  belief.log_likelihood = std::move(log_likelihood);
  belief.log_p_new = log_or_minus_infinity(prior.p_new) + belief.log_likelihood_new;
  belief.log_p_place.resize(prior.p_place.size());
  double highest = belief.log_p_new;
  for (std::size_t i = 0; i < prior.p_place.size(); ++i) {
    belief.log_p_place[i] = log_or_minus_infinity(prior.p_place[i]) + belief.log_likelihood[i];
    highest = std::max(highest, belief.log_p_place[i]);
  }
  if (!std::isfinite(highest)) throw InputError("the observation is impossible at every place that the prior allows");

  belief.p_new = std::exp(belief.log_p_new - highest);
  belief.p_place.resize(prior.p_place.size());
  double sum = belief.p_new;
  for (std::size_t i = 0; i < prior.p_place.size(); ++i) {
    belief.p_place[i] = std::exp(belief.log_p_place[i] - highest);
    sum += belief.p_place[i];
  }
  const double log_evidence = highest + std::log(sum);
  belief.p_new /= sum;
  belief.log_p_new -= log_evidence;
  for (std::size_t i = 0; i < prior.p_place.size(); ++i) {
    belief.p_place[i] /= sum;
    belief.log_p_place[i] -= log_evidence;
  }
  return belief;
}

}  // namespace fabloop
