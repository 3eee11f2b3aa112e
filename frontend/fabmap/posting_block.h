// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frontend/fabmap/observation.h"

namespace fabloop {

/// For each word, the places where it was seen, among at most kCapacity neighbouring places. A place is named by its position in
/// the block, in two bytes.
class PostingBlock {
 public:
  /// The likelihoods of a block fit the second-level cache, so a query goes through a map block by block.
  static constexpr std::size_t kCapacity = 16384;
  using Position = std::uint16_t;

  explicit PostingBlock(std::size_t num_words) : open_(num_words) {}

  /// Appends a place. The caller sees to it that there is room.
  void add_place(std::span<const WordId> words);

  /// Packs the lists tightly, once no place will follow.
  void seal();

  std::size_t num_places() const { return num_places_; }

  /// Places where the word was seen, ascending.
  std::span<const Position> places(WordId word) const {
    if (!open_.empty()) return open_[word];
    return {packed_.data() + begin_[word], packed_.data() + begin_[word + 1]};
  }

  /// Asks for the memory that places() will read: first for where the list is, then for the list.
  void prefetch_list_of(WordId word) const {
    if (open_.empty()) {
      __builtin_prefetch(&begin_[word]);
    } else {
      __builtin_prefetch(&open_[word]);
    }
  }
  void prefetch_places(WordId word) const {
    constexpr std::size_t kPlacesPerLine = 64 / sizeof(Position);
    const std::span<const Position> list = places(word);
    for (std::size_t i = 0; i < list.size(); i += kPlacesPerLine) __builtin_prefetch(list.data() + i);
  }

 private:
  std::size_t num_places_ = 0;
  std::vector<std::vector<Position>> open_;  ///< For each word, until the block is sealed; then empty.
  std::vector<Position> packed_;             ///< Once it is sealed: the lists, one after another,
  std::vector<std::uint32_t> begin_;         ///< and where each begins; and the end of the last.
};

}  // namespace fabloop
