// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_model.h"

#include <utility>

namespace fabloop {

void add_visit(PlaceModel& place, const Observation& observation) {
  PlaceModel merged;
  merged.visits = place.visits + 1;
  merged.words.reserve(place.words.size() + observation.words.size());
  merged.detections.reserve(merged.words.capacity());
  std::size_t old = 0;
  const auto keep_old = [&] {
    merged.words.push_back(place.words[old]);
    merged.detections.push_back(place.detections[old++]);
  };
  for (const WordId word : observation.words) {
    while (old < place.words.size() && place.words[old] < word) keep_old();
    if (old < place.words.size() && place.words[old] == word) {
      keep_old();
      ++merged.detections.back();
    } else {
      merged.words.push_back(word);
      merged.detections.push_back(1);
    }
  }
  while (old < place.words.size()) keep_old();
  place = std::move(merged);
}

}  // namespace fabloop
