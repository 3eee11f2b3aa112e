// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frontend/fabmap/observation.h"

namespace fabloop {

/// For each word, the places that know it, among at most kCapacity neighbouring places. A place is named by its position in the
/// block, in two bytes. The likelihoods of a block's places fit the second-level cache, so a query goes through a map block by
/// block. Places visited once are kept apart from the others, since they have one gain for each word.
class PostingBlock {
 public:
  static constexpr std::size_t kCapacity = 8192;
  using Position = std::uint16_t;

  /// Where a word was seen at places visited several times, ascending, and by which VisitCounts.
  struct Revisited {
    std::vector<Position> places;
    std::vector<std::uint32_t> counts;
  };

  explicit PostingBlock(std::size_t num_words) : open_(num_words) {}

  /// Appends a place visited once. The caller sees to it that there is room.
  void add_place(std::span<const WordId> words);

  /// Packs the lists tightly, once no place will follow.
  void seal();

  /// The place is no longer one visited once.
  void remove_once(Position place, std::span<const WordId> words);

  /// Says, or says anew, by which counts a word was seen at a place visited several times.
  void set_revisited(Position place, WordId word, std::uint32_t counts);

  std::size_t num_places() const { return num_places_; }
  bool has_revisited() const { return !revisited_.empty(); }

  /// Places visited once where the word was seen, ascending.
  std::span<const Position> once(WordId word) const {
    if (!open_.empty()) return open_[word];
    return {packed_.data() + begin_[word], size_[word]};
  }

  /// Only if has_revisited().
  const Revisited& revisited(WordId word) const { return revisited_[word]; }

 private:
  std::size_t num_places_ = 0;
  std::vector<std::vector<Position>> open_;  ///< For each word, until the block is sealed; then empty.
  std::vector<Position> packed_;             ///< Once it is sealed: the lists, one after another,
  std::vector<std::uint32_t> begin_;         ///< where each begins,
  std::vector<std::uint16_t> size_;          ///< and how long it is.
  std::vector<Revisited> revisited_;         ///< For each word; empty until the first revisit.
};

}  // namespace fabloop
