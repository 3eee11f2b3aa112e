// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/observation_model.h"
#include "frontend/fabmap/place_likelihoods.h"
#include "frontend/fabmap/place_model.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

struct Model;

/// Ways to the likelihood of a place that is not in the map.
enum class NewPlaceModel {
  MeanField,  ///< The average place (Glover et al. 2012, eq. 7). Needs nothing but the tree.
  Sampled,    ///< The mean over places seen in training (Glover et al. 2012, eq. 6). They must not be the places that are now
              ///< visited.
  None,       ///< The camera is at one of the places: localisation in a known map, or in time (Glover et al. 2012, section IV-D).
};

/// "mean-field", "sampled", "off": the names used in options and files.
std::string_view to_string(NewPlaceModel new_place);
std::optional<NewPlaceModel> new_place_model_from_string(std::string_view name);

struct PlaceRecognizerOptions {
  LikelihoodEngine engine = LikelihoodEngine::InvertedIndex;
  /// `Sampled` when the model was trained elsewhere; `MeanField` when it was trained on the very places that are visited.
  NewPlaceModel new_place = NewPlaceModel::MeanField;
  /// Only for `Sampled`: at most so many of the background observations are used. Fewer for speed.
  std::size_t max_samples = 500;
  std::uint64_t seed = 1;   ///< Only for `Sampled`: chooses among the background observations.
  BailOutOptions bail_out;  ///< Only for LikelihoodEngine::BailOut.
};

/// FAB-MAP: the places seen so far, and where an image may have been taken among them. Queries are const and may run in
/// parallel; adding must not run beside anything else. Copies what it is given.
class PlaceRecognizer {
 public:
  /// Throws InputError when the tree or the detector is invalid, or `Sampled` is asked for without background observations.
  PlaceRecognizer(ChowLiuTree tree, DetectorModel detector, const std::vector<Observation>& background = {},
                  const PlaceRecognizerOptions& options = {});
  explicit PlaceRecognizer(const Model& model, const PlaceRecognizerOptions& options = {});

  /// Where `observation` was made. `prior` is over the places there are now (see uniform_prior, MotionModel). Throws
  /// InputError when its size is another, or when the observation names a word that the tree does not have. With
  /// NewPlaceModel::None the prior's p_new counts for nothing and p_new is zero, unless there is no place at all.
  Belief recognize(const Observation& observation, const Prior& prior) const;

  /// The same with uniform_prior(num_places()).
  Belief recognize(const Observation& observation) const;

  /// log p(Z | L) of each place: for particle filters and pose filters, which weigh with their own prior, and for localisation.
  /// With LikelihoodEngine::BailOut, upper bounds for those dropped; Belief::bailed_out names them.
  std::vector<double> log_likelihoods(const Observation& observation) const;

  /// log p(Z | a place that is not in the map); minus infinity with NewPlaceModel::None.
  double log_likelihood_new_place(const Observation& observation) const;

  /// A place that was never visited before.
  PlaceId add_place(const Observation& observation);

  /// One more visit of a place. Every visit counts towards its model.
  void add_visit(PlaceId place, const Observation& observation);

  std::size_t num_places() const { return places_.size(); }

  /// What was seen at a place.
  PlaceModel place(PlaceId id) const { return places_[id]; }

 private:
  ObservationModel model_;
  WordTerms terms_;
  PlaceRecognizerOptions options_;
  PlaceLikelihoods places_;
  PlaceLikelihoods samples_;  ///< Places elsewhere, for `Sampled`.
};

}  // namespace fabloop
