// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/place_model.h"

namespace fabloop {

/// What is needed to say how likely an observation is at a place: p(Z | L).
struct ObservationModel {
  ChowLiuTree tree;
  DetectorModel detector;
};

/// What an observation says about a word and its parent. A root counts as a word whose parent was not seen.
enum class WordState : std::uint8_t { Unseen, UnseenParentSeen, SeenParentUnseen, SeenWithParent };
inline constexpr std::size_t kNumWordStates = 4;

/// p(z_q | e_q, z_pq) = 1 / (1 + alpha / beta) (Cummins & Newman 2008; derivation in the README).
double p_word(const ChowLiuNode& node, const DetectorModel& detector, WordState state, bool present);

/// All that the likelihood of one word is made of, at any place.
struct WordLikelihood {
  std::array<double, kNumWordStates> if_present;  ///< p_word in each WordState, its element being present.
  std::array<double, kNumWordStates> if_absent;   ///< The same, its element being absent.
  double odds_anywhere;                           ///< Of the element at the average place.
};

WordLikelihood word_likelihood(const ObservationModel& model, WordId word);

/// p(z_q | z_pq, L) where the element's odds are `odds` (they may be infinite), but for a factor that depends on the odds alone.
inline double unscaled_p(const WordLikelihood& word, WordState state, double odds) {
  const auto s = static_cast<std::size_t>(state);
  return odds > 1.0 ? word.if_present[s] + word.if_absent[s] / odds : word.if_present[s] * odds + word.if_absent[s];
}

/// log p(z_q | z_pq, L): p_word summed over e_q, whose odds are `odds`; they may be infinite.
double log_p(const WordLikelihood& word, WordState state, double odds);

/// log p(z_q | z_pq, L) in each WordState: p_word summed over e_q, for a place visited `visits` times where the word was
/// seen `detections` times. No visits: the average place (mean field).
std::array<double, kNumWordStates> log_p_word(const ObservationModel& model, WordId word, std::uint32_t visits,
                                              std::uint32_t detections);

/// log p(Z | L), word by word over the whole vocabulary: the reference for everything faster. Throws InputError when the
/// observation names a word that the tree does not have.
double log_likelihood(const ObservationModel& model, const PlaceModel& place, const Observation& observation);

/// Throws InputError unless the words ascend, do not repeat, and are below `num_words`.
void validate(const Observation& observation, std::size_t num_words);

}  // namespace fabloop
