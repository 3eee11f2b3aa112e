// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/inverted_index.h"

#include <algorithm>

namespace fabloop {
namespace {

constexpr auto kUnseen = static_cast<std::size_t>(WordState::Unseen);

}  // namespace

InvertedIndex::InvertedIndex(const ObservationModel& model) {
  const std::size_t num_words = model.tree.num_words();
  children_.resize(num_words);
  gain_once_.resize(num_words);
  seen_once_.resize(num_words);
  seen_.resize(num_words);
  for (WordId word = 0; word < num_words; ++word) {
    if (const auto parent = model.tree.nodes[word].parent) children_[*parent].push_back(word);
    gain_once_[word] = gain(model, word, 1, 1);
  }
  for (const std::uint32_t visits : {0u, 1u}) defaults_.emplace(visits, make_defaults(model, visits));
}

InvertedIndex::Defaults InvertedIndex::make_defaults(const ObservationModel& model, std::uint32_t visits) {
  Defaults defaults;
  defaults.change.resize(model.tree.num_words());
  for (WordId word = 0; word < defaults.change.size(); ++word) {
    StateValues values = log_p_word(model, word, visits, 0);
    const double unseen = values[kUnseen];
    defaults.nothing_seen += unseen;
    for (double& value : values) value -= unseen;
    defaults.change[word] = values;
  }
  return defaults;
}

/// log p of the word in each state at a place where it was seen, less that at a place where it never was.
InvertedIndex::StateValues InvertedIndex::gain(const ObservationModel& model, WordId word, std::uint32_t visits,
                                               std::uint32_t detections) {
  StateValues values = log_p_word(model, word, visits, detections);
  const StateValues never_seen = log_p_word(model, word, visits, 0);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= never_seen[i];
  return values;
}

void InvertedIndex::add_place(const ObservationModel& model, const PlaceModel& place) {
  visits_.push_back(0);
  nothing_seen_.push_back(0.0);
  insert(model, static_cast<PlaceId>(visits_.size() - 1), place);
}

void InvertedIndex::add_visit(const ObservationModel& model, PlaceId id, const PlaceModel& before, const PlaceModel& after) {
  for (const WordId word : before.words) {
    if (before.visits == 1) {
      auto& places = seen_once_[word];
      places.erase(std::lower_bound(places.begin(), places.end(), id));
    } else {
      auto& postings = seen_[word];
      postings.erase(std::lower_bound(postings.begin(), postings.end(), id,
                                      [](const Posting& posting, PlaceId place) { return posting.place < place; }));
    }
  }
  insert(model, id, after);
}

void InvertedIndex::insert(const ObservationModel& model, PlaceId id, const PlaceModel& place) {
  if (!defaults_.contains(place.visits)) defaults_.emplace(place.visits, make_defaults(model, place.visits));
  visits_[id] = place.visits;
  nothing_seen_[id] = 0.0;
  for (std::size_t i = 0; i < place.words.size(); ++i) {
    const WordId word = place.words[i];
    if (place.visits == 1) {
      auto& places = seen_once_[word];
      places.insert(std::lower_bound(places.begin(), places.end(), id), id);
      nothing_seen_[id] += gain_once_[word][kUnseen];
    } else {
      auto& postings = seen_[word];
      const auto at = std::lower_bound(postings.begin(), postings.end(), id,
                                       [](const Posting& posting, PlaceId other) { return posting.place < other; });
      postings.insert(at, {id, place.detections[i]});
      nothing_seen_[id] += gain(model, word, place.visits, place.detections[i])[kUnseen];
    }
  }
}

std::vector<InvertedIndex::Affected> InvertedIndex::affected_words(const Observation& observation) const {
  std::vector<Affected> affected;
  const auto is_seen = [&](WordId word) { return std::binary_search(observation.words.begin(), observation.words.end(), word); };
  std::vector<WordId> seen_with_parent;
  for (const WordId word : observation.words) {
    for (const WordId child : children_[word]) {
      const bool child_seen = is_seen(child);
      if (child_seen) seen_with_parent.push_back(child);
      const auto state = child_seen ? WordState::SeenWithParent : WordState::UnseenParentSeen;
      affected.push_back({child, static_cast<std::size_t>(state)});
    }
  }
  std::sort(seen_with_parent.begin(), seen_with_parent.end());
  for (const WordId word : observation.words) {
    if (std::binary_search(seen_with_parent.begin(), seen_with_parent.end(), word)) continue;
    affected.push_back({word, static_cast<std::size_t>(WordState::SeenParentUnseen)});
  }
  return affected;
}

double InvertedIndex::likelihood_where_never_seen(const Defaults& defaults, const std::vector<Affected>& affected) {
  double result = defaults.nothing_seen;
  for (const auto& [word, state] : affected) result += defaults.change[word][state];
  return result;
}

std::vector<double> InvertedIndex::log_likelihoods(const ObservationModel& model, const Observation& observation) const {
  const std::vector<Affected> affected = affected_words(observation);
  std::vector<double> default_by_visits(defaults_.rbegin()->first + 1, 0.0);
  for (const auto& [visits, defaults] : defaults_) default_by_visits[visits] = likelihood_where_never_seen(defaults, affected);

  std::vector<double> result(visits_.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = default_by_visits[visits_[i]] + nothing_seen_[i];
  for (const auto& [word, state] : affected) {
    const double once = gain_once_[word][state] - gain_once_[word][kUnseen];
    for (const PlaceId place : seen_once_[word]) result[place] += once;
    for (const auto& [place, detections] : seen_[word]) {
      const StateValues values = gain(model, word, visits_[place], detections);
      result[place] += values[state] - values[kUnseen];
    }
  }
  return result;
}

double InvertedIndex::log_likelihood_unvisited(const Observation& observation) const {
  return likelihood_where_never_seen(defaults_.at(0), affected_words(observation));
}

}  // namespace fabloop
