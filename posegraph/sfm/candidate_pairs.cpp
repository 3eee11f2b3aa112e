// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/candidate_pairs.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "frontend/fabmap/place_recognizer.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/spatially_even.h"
#include "frontend/parallel.h"
#include "posegraph/own_model.h"

namespace fabloop {
namespace {

Model train_on(const std::vector<View>& views, const CandidatePairsOptions& options) {
  OwnModelOptions training;
  training.features.kind.descriptor = views.front().features.descriptor_kind;
  constexpr std::size_t kMaxDescriptors = 50000;
  training.max_descriptors = kMaxDescriptors;
  training.seed = options.seed;
  training.num_threads = options.num_threads;
  training.progress = options.progress;
  const auto source = [&](std::size_t i) { return first_features(views[i].features, options.num_training_features); };
  return train_own_model(views.size(), source, training).model;
}

/// The best `count` of the others by falling score.
std::vector<std::size_t> best_others(const std::vector<double>& scores, std::size_t self, const CandidatePairsOptions& options,
                                     std::size_t count) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (std::max(i, self) - std::min(i, self) > options.num_neighbours) others.push_back(i);
  }
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  others.resize(std::min(others.size(), count));
  return others;
}

std::vector<std::vector<std::size_t>> hypotheses(const std::vector<View>& views, const Model& model,
                                                 const CandidatePairsOptions& options) {
  const WordFinder words(model.vocabulary);
  std::vector<Observation> observations(views.size());
  parallel_for(views.size(), options.num_threads, [&](std::size_t i) {
    observations[i] = words.observe(first_features(views[i].features, options.num_training_features).descriptors);
  });
  PlaceRecognizer recognizer(model);
  for (const Observation& observation : observations) recognizer.add_place(observation);
  std::vector<std::vector<std::size_t>> result(views.size());
  parallel_for(views.size(), options.num_threads, [&](std::size_t i) {
    result[i] = best_others(recognizer.log_likelihoods(observations[i]), i, options, options.num_hypotheses);
  });
  return result;
}

std::vector<std::size_t> nearest(const std::vector<std::optional<Eigen::Vector3d>>& positions, std::size_t self,
                                 const CandidatePairsOptions& options) {
  if (!positions[self]) return {};
  constexpr double kNowhere = -1e300;
  std::vector<double> scores;
  for (const auto& position : positions) scores.push_back(position ? -(*position - *positions[self]).norm() : kNowhere);
  std::vector<std::size_t> others = best_others(scores, self, options, options.num_nearest);
  std::erase_if(others, [&](std::size_t i) { return scores[i] == kNowhere; });
  return others;
}

}  // namespace

std::vector<CandidatePair> candidate_pairs(const std::vector<View>& views, const std::optional<Model>& model,
                                           const std::vector<std::optional<Eigen::Vector3d>>& positions,
                                           const CandidatePairsOptions& options) {
  std::set<CandidatePair> pairs;
  const auto add = [&](std::size_t a, std::size_t b) { pairs.insert({std::max(a, b), std::min(a, b)}); };
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t k = 1; k <= options.num_neighbours && k <= i; ++k) add(i, i - k);
  }
  if (options.num_hypotheses > 0 && views.size() > options.num_neighbours + 1) {
    const auto similar = hypotheses(views, model ? *model : train_on(views, options), options);
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (const std::size_t other : similar[i]) add(i, other);
    }
  }
  if (options.num_nearest > 0 && positions.size() == views.size()) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (const std::size_t other : nearest(positions, i, options)) add(i, other);
    }
  }
  return {pairs.begin(), pairs.end()};
}

}  // namespace fabloop
