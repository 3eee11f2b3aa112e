// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/likelihood_table.h"

namespace fabloop {

void LikelihoodTable::add(const ObservationModel& model, const PlaceModel& place) {
  PlacesAlike& places = by_visits_[place.visits];
  ++places.num_places;
  std::vector<Row>& rows = places.rows;
  rows.resize(place.visits + 1);
  const auto make_row = [&](std::uint32_t detections) {
    Row& row = rows[detections];
    if (!row.empty()) return;
    row.reserve(model.tree.num_words());
    for (WordId word = 0; word < model.tree.num_words(); ++word) {
      row.push_back(log_p_word(model, word, place.visits, detections));
    }
  };
  make_row(0);
  for (const std::uint32_t detections : place.detections) make_row(detections);
}

void LikelihoodTable::remove(const PlaceModel& place) {
  if (--by_visits_.at(place.visits).num_places == 0) by_visits_.erase(place.visits);
}

std::vector<double> LikelihoodTable::log_likelihoods(const WordTerms& terms, const PlaceStore& places,
                                                     const Observation& observation) const {
  std::vector<std::uint8_t> states(terms.num_words(), static_cast<std::uint8_t>(WordState::Unseen));
  for (const auto& [word, state] : terms.affected_words(observation)) states[word] = static_cast<std::uint8_t>(state);
  std::map<std::uint32_t, double> where_never_seen;
  for (const auto& [visits, alike] : by_visits_) {
    double& sum = where_never_seen[visits];
    for (WordId word = 0; word < states.size(); ++word) sum += alike.rows[0][word][states[word]];
  }
  std::vector<double> result;
  result.reserve(places.size());
  for (PlaceId place = 0; place < places.size(); ++place) {
    const std::uint32_t visits = places.visits(place);
    const std::vector<Row>& rows = by_visits_.at(visits).rows;
    double sum = where_never_seen[visits];
    places.for_each_word(place, [&](WordId word, std::uint32_t detections) {
      sum += rows[detections][word][states[word]] - rows[0][word][states[word]];
    });
    result.push_back(sum);
  }
  return result;
}

}  // namespace fabloop
