// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/hypotheses.h"

#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

/// log(sum(exp)) of the new place and the first `num_places` places.
double log_sum(const Belief& belief, std::size_t num_places) {
  double highest = belief.log_p_new;
  for (std::size_t i = 0; i < num_places; ++i) highest = std::max(highest, belief.log_p_place[i]);
  if (!std::isfinite(highest)) return highest;
  double sum = std::exp(belief.log_p_new - highest);
  for (std::size_t i = 0; i < num_places; ++i) sum += std::exp(belief.log_p_place[i] - highest);
  return highest + std::log(sum);
}

}  // namespace

std::vector<Hypothesis> ranked_hypotheses(const Belief& belief, const HypothesesOptions& options) {
  const std::size_t num_places = belief.log_p_place.size();
  const std::size_t kept = num_places - std::min(options.num_recent_excluded, num_places);
  const double log_total = log_sum(belief, kept);
  std::vector<PlaceId> order;
  for (PlaceId place = 0; place < kept; ++place) {
    if (!std::isfinite(belief.log_p_place[place])) continue;
    if (std::exp(belief.log_p_place[place] - log_total) >= options.min_probability) order.push_back(place);
  }
  const auto is_better = [&](PlaceId a, PlaceId b) {
    if (belief.log_p_place[a] != belief.log_p_place[b]) return belief.log_p_place[a] > belief.log_p_place[b];
    if (belief.log_likelihood[a] != belief.log_likelihood[b]) return belief.log_likelihood[a] > belief.log_likelihood[b];
    return a < b;
  };
  const std::size_t wanted = std::min(options.max_hypotheses, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(wanted), order.end(), is_better);
  std::vector<Hypothesis> result;
  for (std::size_t i = 0; i < wanted; ++i) {
    const PlaceId place = order[i];
    result.push_back({place, std::exp(belief.log_p_place[place] - log_total), belief.log_likelihood[place]});
  }
  return result;
}

}  // namespace fabloop
