// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_store.h"

namespace fabloop {
namespace {

/// Seven bits a byte, the lowest first; the highest bit says that more follow.
void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
  for (; number >= 0x80u; number >>= 7) bytes.push_back(static_cast<std::uint8_t>(number | 0x80u));
  bytes.push_back(static_cast<std::uint8_t>(number));
}

std::vector<std::uint8_t> encoded(const PlaceModel& place) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * place.words.size());
  for (std::size_t i = 0; i < place.words.size(); ++i) {
    append_number(bytes, i == 0 ? place.words[0] : place.words[i] - place.words[i - 1] - 1);
    if (place.visits > 1) append_number(bytes, place.detections[i]);
  }
  bytes.shrink_to_fit();
  return bytes;
}

}  // namespace

PlaceModel PlaceStore::operator[](PlaceId place) const {
  PlaceModel model;
  model.visits = visits_[place];
  for_each_word(place, [&](WordId word, std::uint32_t detections) {
    model.words.push_back(word);
    model.detections.push_back(detections);
  });
  return model;
}

void PlaceStore::push_back(const PlaceModel& place) {
  places_.push_back(encoded(place));
  visits_.push_back(place.visits);
}

void PlaceStore::set(PlaceId place, const PlaceModel& model) {
  places_[place] = encoded(model);
  visits_[place] = model.visits;
}

}  // namespace fabloop
