// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/self_test.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "frontend/fabmap/place_recognizer.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/tree_likelihood.h"

namespace fabloop {
namespace {

constexpr std::size_t kNeighbourDistance = 3;

void test_tree(const HeldOut& held_out, SelfTest& result) {
  const TreeLikelihood with_links(held_out.tree), without_links(naive_bayes(held_out.tree));
  const auto count = static_cast<double>(held_out.images.size());
  result.num_held_out = held_out.images.size();
  for (const Observation& image : held_out.images) {
    result.tree_log_likelihood += with_links(image) / count;
    result.naive_bayes_log_likelihood += without_links(image) / count;
  }
}

/// The place with the highest likelihood, `left_out` aside; the lowest of equals.
std::size_t likeliest(const PlaceRecognizer& places, const Observation& query, std::size_t left_out) {
  std::vector<double> likelihood = places.log_likelihoods(query);
  if (left_out < likelihood.size()) likelihood[left_out] = -std::numeric_limits<double>::infinity();
  return static_cast<std::size_t>(std::max_element(likelihood.begin(), likelihood.end()) - likelihood.begin());
}

void test_recall(const ChowLiuTree& tree, const std::vector<Observation>& observations,
                 const std::vector<Observation>& two_thirds, const SelfTestOptions& options, SelfTest& result) {
  const std::size_t num_places = std::min(observations.size(), options.max_places);
  if (num_places < 2) return;
  PlaceRecognizer places(tree, options.detector);
  for (std::size_t image = 0; image < num_places; ++image) places.add_place(observations[image]);
  for (const std::size_t image : sample_without_replacement(num_places, options.max_queries, options.seed)) {
    if (observations[image].words.empty()) continue;
    ++result.num_recall_queries;
    if (likeliest(places, two_thirds[image], num_places) == image) ++result.num_recalled;
    ++result.num_neighbour_queries;
    const std::size_t other = likeliest(places, observations[image], image);
    if (std::max(other, image) - std::min(other, image) <= kNeighbourDistance) ++result.num_neighbours_first;
  }
}

}  // namespace

SelfTest self_test(const ChowLiuTree& tree, const std::vector<Observation>& observations,
                   const std::vector<Observation>& two_thirds, const std::optional<HeldOut>& held_out,
                   const SelfTestOptions& options) {
  assert(observations.size() == two_thirds.size());
  SelfTest result;
  if (held_out) test_tree(*held_out, result);
  test_recall(tree, observations, two_thirds, options, result);
  return result;
}

}  // namespace fabloop
