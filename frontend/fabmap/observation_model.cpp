// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/observation_model.h"

#include <cmath>
#include <string>
#include <vector>

#include "frontend/error.h"

namespace fabloop {
namespace {

bool is_seen(WordState state) { return state == WordState::SeenParentUnseen || state == WordState::SeenWithParent; }

bool is_parent_seen(WordState state) { return state == WordState::UnseenParentSeen || state == WordState::SeenWithParent; }

WordState word_state(bool seen, bool parent_seen) {
  if (seen) return parent_seen ? WordState::SeenWithParent : WordState::SeenParentUnseen;
  return parent_seen ? WordState::UnseenParentSeen : WordState::Unseen;
}

}  // namespace

double p_word(const ChowLiuNode& node, const DetectorModel& detector, WordState state, bool present) {
  const bool seen = is_seen(state);
  const double p_seen_given_parent = is_parent_seen(state) ? node.p_if_parent : node.p_if_no_parent;
  const double p_z = seen ? node.p : 1.0 - node.p;
  const double p_z_given_parent = seen ? p_seen_given_parent : 1.0 - p_seen_given_parent;
  const double alpha = p_z * p_seen_given_present(detector, !seen, present) * (1.0 - p_z_given_parent);
  const double beta = (1.0 - p_z) * p_seen_given_present(detector, seen, present) * p_z_given_parent;
  return beta / (alpha + beta);
}

WordLikelihood word_likelihood(const ObservationModel& model, WordId word) {
  const ChowLiuNode& node = model.tree.nodes[word];
  WordLikelihood result{};
  for (std::size_t i = 0; i < kNumWordStates; ++i) {
    result.if_present[i] = p_word(node, model.detector, static_cast<WordState>(i), true);
    result.if_absent[i] = p_word(node, model.detector, static_cast<WordState>(i), false);
  }
  const double p = p_present_anywhere(model.detector, node.p);
  result.odds_anywhere = p / (1.0 - p);
  return result;
}

double log_p(const WordLikelihood& word, WordState state, double odds) {
  return std::log(unscaled_p(word, state, odds) / (odds > 1.0 ? 1.0 + 1.0 / odds : 1.0 + odds));
}

std::array<double, kNumWordStates> log_p_word(const ObservationModel& model, WordId word, std::uint32_t visits,
                                              std::uint32_t detections) {
  const WordLikelihood likelihood = word_likelihood(model, word);
  const double odds = likelihood.odds_anywhere * presence_factor(model.detector, visits, detections);
  std::array<double, kNumWordStates> result{};
  for (std::size_t i = 0; i < kNumWordStates; ++i) result[i] = log_p(likelihood, static_cast<WordState>(i), odds);
  return result;
}

double log_likelihood(const ObservationModel& model, const PlaceModel& place, const Observation& observation) {
  const std::size_t num_words = model.tree.num_words();
  validate(observation, num_words);
  std::vector<char> seen(num_words, 0);
  for (const WordId word : observation.words) seen[word] = 1;
  double result = 0.0;
  std::size_t next = 0;
  for (WordId word = 0; word < num_words; ++word) {
    const bool known = next < place.words.size() && place.words[next] == word;
    const std::uint32_t detections = known ? place.detections[next++] : 0;
    const auto parent = model.tree.nodes[word].parent;
    const WordState state = word_state(seen[word] != 0, parent && seen[*parent] != 0);
    result += log_p_word(model, word, place.visits, detections)[static_cast<std::size_t>(state)];
  }
  return result;
}

void validate(const Observation& observation, std::size_t num_words) {
  for (std::size_t i = 0; i < observation.words.size(); ++i) {
    if (observation.words[i] >= num_words) {
      throw InputError("the observation has word " + std::to_string(observation.words[i]) + " but the model only " +
                       std::to_string(num_words) + " words; make it with the model's own vocabulary");
    }
    if (i > 0 && observation.words[i] <= observation.words[i - 1]) {
      throw InputError("the observation's words do not ascend at word " + std::to_string(observation.words[i]) +
                       "; sort them and drop repeats");
    }
  }
}

}  // namespace fabloop
