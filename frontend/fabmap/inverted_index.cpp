// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/inverted_index.h"

#include <algorithm>

namespace fabloop {
namespace {

constexpr std::size_t kCapacity = PostingBlock::kCapacity;

PostingBlock::Position position(PlaceId place) { return static_cast<PostingBlock::Position>(place % kCapacity); }

/// WordTerms::change_of_gain of one word after another by VisitCounts, each computed once: a map has fewer counts than places.
class ChangesByCounts {
 public:
  ChangesByCounts(const WordTerms& terms, const VisitCounts& counts)
      : terms_(terms), counts_(counts), value_(counts.size()), word_of_value_(counts.size(), 0) {}

  void next_word(const AffectedWord& word) {
    word_ = word;
    ++number_;
  }
  double operator()(std::uint32_t id) {
    if (word_of_value_[id] != number_) {
      word_of_value_[id] = number_;
      value_[id] = terms_.change_of_gain(word_, counts_[id]);
    }
    return value_[id];
  }

 private:
  const WordTerms& terms_;
  const VisitCounts& counts_;
  AffectedWord word_{};
  std::uint32_t number_ = 0;  ///< Of the word, from one.
  std::vector<double> value_;
  std::vector<std::uint32_t> word_of_value_;
};

}  // namespace

void InvertedIndex::add_place(const WordTerms& terms, VisitCounts& counts, const Observation& observation) {
  if (gain_once_.empty()) {
    const Counts once = counts[VisitCounts::kOnce];
    for (WordId word = 0; word < terms.num_words(); ++word) gain_once_.push_back(terms.gain(word, once));
  }
  if (blocks_.empty() || blocks_.back().num_places() == kCapacity) {
    if (!blocks_.empty()) blocks_.back().seal();
    blocks_.emplace_back(terms.num_words());
  }
  blocks_.back().add_place(observation.words);
  visits_.push_back(1);
  count_place(terms, 1);
  double nothing_seen = 0.0;
  for (const WordId word : observation.words) nothing_seen += gain_once_[word];
  nothing_seen_.push_back(nothing_seen);
}

void InvertedIndex::add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId id, const PlaceModel& before,
                              const PlaceModel& after) {
  PostingBlock& block = blocks_[id / kCapacity];
  if (before.visits == 1) block.remove_once(position(id), before.words);
  visits_[id] = after.visits;
  double nothing_seen = 0.0;
  for (std::size_t i = 0; i < after.words.size(); ++i) {
    const std::uint32_t counts_id = counts.id(after.visits, after.detections[i]);
    block.set_revisited(position(id), after.words[i], counts_id);
    nothing_seen += terms.gain(after.words[i], counts[counts_id]);
  }
  nothing_seen_[id] = nothing_seen;
  if (--by_visits_.at(before.visits).num_places == 0) by_visits_.erase(before.visits);
  count_place(terms, after.visits);
}

void InvertedIndex::count_place(const WordTerms& terms, std::uint32_t visits) {
  PlacesAlike& places = by_visits_[visits];
  if (places.num_places++ == 0) {
    places.nothing_seen_where_never_seen = terms.nothing_seen_where_never_seen(presence_factor(terms.detector(), visits, 0));
  }
}

std::vector<double> InvertedIndex::log_likelihoods(const WordTerms& terms, const VisitCounts& counts,
                                                   const Observation& observation) const {
  const Query query = prepare(terms, counts, observation);
  std::vector<double> result(visits_.size());
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    start_block(query, block, result.data() + block * kCapacity);
    add_words_to_block(terms, counts, query.words, block, result.data() + block * kCapacity);
  }
  return result;
}

InvertedIndex::Query InvertedIndex::prepare(const WordTerms& terms, const VisitCounts& counts,
                                            const Observation& observation) const {
  Query query;
  if (visits_.empty()) return query;
  const Counts once = counts[VisitCounts::kOnce];
  for (const AffectedWord& affected : terms.affected_words(observation)) {
    query.words.push_back({affected, terms.change_of_gain(affected, once)});
  }
  for (const auto& [visits, places] : by_visits_) {
    double sum = places.nothing_seen_where_never_seen;
    const double factor = presence_factor(terms.detector(), visits, 0);
    for (const QueryWord& word : query.words) sum += terms.change_where_never_seen(word.affected, factor);
    query.where_never_seen[visits] = sum;
  }
  return query;
}

std::vector<double> InvertedIndex::start(const Query& query) const {
  std::vector<double> result(visits_.size());
  for (std::size_t block = 0; block < blocks_.size(); ++block) start_block(query, block, result.data() + block * kCapacity);
  return result;
}

void InvertedIndex::add_words(const WordTerms& terms, const VisitCounts& counts, std::span<const QueryWord> words,
                              std::vector<double>& log_likelihood) const {
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    add_words_to_block(terms, counts, words, block, log_likelihood.data() + block * kCapacity);
  }
}

void InvertedIndex::start_block(const Query& query, std::size_t block, double* log_likelihood) const {
  const std::size_t first = block * kCapacity;
  std::uint32_t visits = visits_[first];
  double where_never_seen = query.where_never_seen.at(visits);
  for (std::size_t i = 0; i < blocks_[block].num_places(); ++i) {
    if (visits_[first + i] != visits) where_never_seen = query.where_never_seen.at(visits = visits_[first + i]);
    log_likelihood[i] = where_never_seen + nothing_seen_[first + i];
  }
}

void InvertedIndex::add_words_to_block(const WordTerms& terms, const VisitCounts& counts, std::span<const QueryWord> words,
                                       std::size_t block, double* log_likelihood) const {
  for (const QueryWord& word : words) {
    for (const auto place : blocks_[block].once(word.affected.word)) log_likelihood[place] += word.change_once;
  }
  if (!blocks_[block].has_revisited()) return;
  ChangesByCounts changes(terms, counts);
  for (const QueryWord& word : words) {
    const PostingBlock::Revisited& list = blocks_[block].revisited(word.affected.word);
    changes.next_word(word.affected);
    for (std::size_t i = 0; i < list.places.size(); ++i) log_likelihood[list.places[i]] += changes(list.counts[i]);
  }
}

}  // namespace fabloop
