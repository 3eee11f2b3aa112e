// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/revisited_places.h"

#include <algorithm>

namespace fabloop {

void RevisitedPlaces::add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId place, const PlaceModel& before,
                                const PlaceModel& after) {
  postings_.resize(terms.num_words());
  const auto [entry, is_first] = number_of_place_.try_emplace(place, static_cast<std::uint32_t>(places_.size()));
  const std::uint32_t number = entry->second;
  if (is_first) {
    places_.push_back(place);
    nothing_seen_.push_back(0.0);
    visits_.push_back(after.visits);
  } else if (--num_places_.at(before.visits) == 0) {
    num_places_.erase(before.visits);
    where_never_seen_.erase(before.visits);
  }
  visits_[number] = after.visits;
  if (num_places_[after.visits]++ == 0) {
    where_never_seen_[after.visits] = terms.nothing_seen_where_never_seen(presence_factor(terms.detector(), after.visits, 0));
  }
  double nothing_seen = 0.0;
  for (std::size_t i = 0; i < after.words.size(); ++i) {
    const std::uint32_t counts_id = counts.id(after.visits, after.detections[i]);
    set(number, after.words[i], counts_id);
    nothing_seen += terms.gain(after.words[i], counts[counts_id]);
  }
  nothing_seen_[number] = nothing_seen;
}

void RevisitedPlaces::set(std::uint32_t number, WordId word, std::uint32_t counts) {
  Postings& list = postings_[word];
  const auto at = std::lower_bound(list.places.begin(), list.places.end(), number);
  const auto counts_at = list.counts.begin() + (at - list.places.begin());
  if (at != list.places.end() && *at == number) {
    *counts_at = counts;
  } else {
    list.places.insert(at, number);
    list.counts.insert(counts_at, counts);
  }
}

std::vector<double> RevisitedPlaces::start(const std::map<std::uint32_t, double>& where_never_seen) const {
  std::vector<double> result;
  for (std::size_t i = 0; i < places_.size(); ++i) result.push_back(where_never_seen.at(visits_[i]) + nothing_seen_[i]);
  return result;
}

std::vector<double> RevisitedPlaces::gather(const std::vector<double>& of_all_places) const {
  std::vector<double> result;
  for (const PlaceId place : places_) result.push_back(of_all_places[place]);
  return result;
}

void RevisitedPlaces::scatter(const std::vector<double>& log_likelihood, std::vector<double>& of_all_places) const {
  for (std::size_t i = 0; i < places_.size(); ++i) of_all_places[places_[i]] = log_likelihood[i];
}

void RevisitedPlaces::add_words(const WordTerms& terms, const VisitCounts& counts, std::span<const AffectedWord> words,
                                std::vector<double>& log_likelihood) const {
  if (places_.empty()) return;
  std::vector<double> change(counts.size());
  std::vector<std::uint32_t> word_of_change(counts.size(), 0);  // counted from one
  std::uint32_t word_number = 0;
  for (const AffectedWord& word : words) {
    const Postings& list = postings_[word.word];
    ++word_number;
    for (std::size_t i = 0; i < list.places.size(); ++i) {
      const std::uint32_t id = list.counts[i];
      if (word_of_change[id] != word_number) {
        word_of_change[id] = word_number;
        change[id] = terms.change_of_gain(word, counts[id]);
      }
      log_likelihood[list.places[i]] += change[id];
    }
  }
}

}  // namespace fabloop
