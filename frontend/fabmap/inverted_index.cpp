// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/inverted_index.h"

#include <array>

namespace fabloop {
namespace {

constexpr std::size_t kCapacity = PostingBlock::kCapacity;

/// Adds `change` at each of the places, which are different: so several may be on their way at once.
void add_to_places(std::span<const PostingBlock::Position> places, double change, double* log_likelihood) {
  constexpr std::size_t kAtOnce = 8;
  const PostingBlock::Position* place = places.data();
  const PostingBlock::Position* const end = place + places.size();
  for (; end - place >= static_cast<std::ptrdiff_t>(kAtOnce); place += kAtOnce) {
    std::array<double, kAtOnce> changed;
    for (std::size_t i = 0; i < kAtOnce; ++i) changed[i] = log_likelihood[place[i]] + change;
    for (std::size_t i = 0; i < kAtOnce; ++i) log_likelihood[place[i]] = changed[i];
  }
  for (; place != end; ++place) log_likelihood[*place] += change;
}

/// Adds what words from `first` up to `last` say to the likelihoods of a block's places, as their first visits left them.
void add_words_to_block(const PostingBlock& block, const InvertedIndex::Query& query, std::size_t first, std::size_t last,
                        double* log_likelihood) {
  // Lists lie apart, each shorter than a prefetcher needs to see a pattern.
  constexpr std::size_t kSoon = 2, kLater = 12;
  for (std::size_t i = first; i < last; ++i) {
    if (i + kLater < last) block.prefetch_list_of(query.words[i + kLater].word);
    if (i + kSoon < last) block.prefetch_places(query.words[i + kSoon].word);
    add_to_places(block.places(query.words[i].word), query.change_once[i], log_likelihood);
  }
}

}  // namespace

void InvertedIndex::add_place(const WordTerms& terms, const VisitCounts& counts, const Observation& observation) {
  if (gain_once_.empty()) {
    const Counts& once = counts[VisitCounts::kOnce];
    for (WordId word = 0; word < terms.num_words(); ++word) gain_once_.push_back(terms.gain(word, once));
    nothing_seen_where_never_seen_ = terms.nothing_seen_where_never_seen(once.factor_unseen);
  }
  if (blocks_.empty() || blocks_.back().num_places() == kCapacity) {
    if (!blocks_.empty()) blocks_.back().seal();
    blocks_.emplace_back(terms.num_words());
  }
  blocks_.back().add_place(observation.words);
  double gains = 0.0;
  for (const WordId word : observation.words) gains += gain_once_[word];
  nothing_seen_.push_back(nothing_seen_where_never_seen_ + gains);
}

void InvertedIndex::add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId id, const PlaceModel& before,
                              const PlaceModel& after) {
  revisited_.add_visit(terms, counts, id, before, after);
}

std::vector<double> InvertedIndex::log_likelihoods(const WordTerms& terms, const VisitCounts& counts,
                                                   const Observation& observation) const {
  const Query query = prepare(terms, counts, observation);
  std::vector<double> result = start(query);
  add_words(terms, counts, query, 0, query.words.size(), result);
  return result;
}

InvertedIndex::Query InvertedIndex::prepare(const WordTerms& terms, const VisitCounts& counts,
                                            const Observation& observation) const {
  Query query;
  query.words = terms.affected_words(observation);
  const Counts& once = counts[VisitCounts::kOnce];
  for (const AffectedWord& word : query.words) query.change_once.push_back(terms.change_of_gain(word, once));
  query.where_never_seen = revisited_.where_never_seen();
  query.where_never_seen[1] = nothing_seen_where_never_seen_;
  for (auto& [visits, log_likelihood] : query.where_never_seen) {
    const double factor = presence_factor(terms.detector(), visits, 0);
    for (const AffectedWord& word : query.words) log_likelihood += terms.change_where_never_seen(word, factor);
  }
  return query;
}

std::vector<double> InvertedIndex::start(const Query& query) const {
  const double change = query.where_never_seen.at(1) - nothing_seen_where_never_seen_;
  std::vector<double> result = nothing_seen_;
  for (double& log_likelihood : result) log_likelihood += change;
  revisited_.scatter(revisited_.start(query.where_never_seen), result);
  return result;
}

void InvertedIndex::add_words(const WordTerms& terms, const VisitCounts& counts, const Query& query, std::size_t first,
                              std::size_t last, std::vector<double>& log_likelihood) const {
  // The revisited places are set aside, since the blocks know of their first visits only.
  std::vector<double> revisited = revisited_.gather(log_likelihood);
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    add_words_to_block(blocks_[block], query, first, last, log_likelihood.data() + block * kCapacity);
  }
  revisited_.add_words(terms, counts, std::span(query.words).subspan(first, last - first), revisited);
  revisited_.scatter(revisited, log_likelihood);
}

}  // namespace fabloop
