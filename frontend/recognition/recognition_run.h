// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "frontend/fabmap/appearance_slam.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/precision_recall.h"
#include "frontend/progress.h"
#include "frontend/recognition/observed_images.h"

namespace fabloop {

/// A place that an image may show.
struct PlaceMatch {
  PlaceId place = 0;
  double probability = 0.0;     ///< Among the places that are not excluded, and the new place.
  double log_likelihood = 0.0;  ///< log p(Z | place).
  double log_odds = 0.0;        ///< log of probability / (1 - probability): still tells apart what rounds to one.
};

/// What was made of one image.
struct RecognizedImage {
  std::size_t frame = 0;
  std::int64_t time_ns = 0;
  std::size_t num_words = 0;
  std::size_t num_places = 0;       ///< In the map before this image; of them the most recent ones are excluded.
  PlaceId place = 0;                ///< Where it was put, or, in a map that stays as it is, the most probable place.
  bool is_new = false;              ///< It became a new place, or is more probably at none of the map's places.
  double p_new = 1.0;               ///< Given that it is at none of the excluded places.
  std::vector<PlaceMatch> matches;  ///< The most probable first.
  double recognize_s = 0.0;
};

/// A sequence recognised, image by image.
struct Recognition {
  std::vector<RecognizedImage> images;
  PlaceFrames places;                        ///< The frames of each place: of this sequence, or of the map's.
  std::vector<std::int64_t> place_times_ns;  ///< When each place was first seen.
};

/// Called for each image in turn. `p_place` is over the places that are not excluded and sums to one with p_new;
/// `log_likelihood` is over all places.
using BeliefRow = std::function<void(std::span<const double> p_place, std::span<const double> log_likelihood)>;

struct RecognitionOptions {
  AppearanceSlamOptions slam;
  std::size_t max_matches = 10;  ///< How many places are kept for each image.
  /// So many of the most recent places are left out, and out of the normalisation too, since their views overlap the present
  /// one; see HypothesesOptions. Zero in a map of another time.
  std::size_t num_recent_excluded = 10;
  BeliefRow on_row;
  Warn warn{};  ///< Told once when the images look unlike those that the model was trained on; see DomainCheck.
  Progress progress;
};

/// Recognises each image among those before it, then adds it to them.
Recognition recognize_sequence(const Model& model, const std::vector<ObservedImage>& images,
                               const RecognitionOptions& options = {});

/// Makes places of the map's images, and recognises each of `queries` among them; the map stays as it is.
Recognition recognize_in_map(const Model& model, const std::vector<ObservedImage>& map, const std::vector<ObservedImage>& queries,
                             const RecognitionOptions& options = {});

/// The matches as answers to be judged, by their log odds. Excluded places count as places that were not found.
std::vector<ScoredQuery> scored_queries(const Recognition& recognition);

}  // namespace fabloop
