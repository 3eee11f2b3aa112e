// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/posting_block.h"

#include <algorithm>
#include <cassert>

namespace fabloop {

void PostingBlock::add_place(std::span<const WordId> words) {
  assert(!open_.empty() && num_places_ < kCapacity);
  const auto place = static_cast<Position>(num_places_++);
  for (const WordId word : words) open_[word].push_back(place);
}

void PostingBlock::seal() {
  std::size_t total = 0;
  for (const auto& places : open_) total += places.size();
  packed_.reserve(total);
  begin_.reserve(open_.size());
  size_.reserve(open_.size());
  for (const auto& places : open_) {
    begin_.push_back(static_cast<std::uint32_t>(packed_.size()));
    size_.push_back(static_cast<std::uint16_t>(places.size()));
    packed_.insert(packed_.end(), places.begin(), places.end());
  }
  open_ = {};
}

void PostingBlock::remove_once(Position place, std::span<const WordId> words) {
  for (const WordId word : words) {
    if (!open_.empty()) {
      auto& places = open_[word];
      places.erase(std::lower_bound(places.begin(), places.end(), place));
      continue;
    }
    Position* const begin = packed_.data() + begin_[word];
    Position* const end = begin + size_[word]--;
    std::move(std::lower_bound(begin, end, place) + 1, end, std::lower_bound(begin, end, place));
  }
}

void PostingBlock::set_revisited(Position place, WordId word, std::uint32_t counts) {
  if (revisited_.empty()) revisited_.resize(open_.empty() ? size_.size() : open_.size());
  Revisited& list = revisited_[word];
  const auto at = std::lower_bound(list.places.begin(), list.places.end(), place);
  const auto counts_at = list.counts.begin() + (at - list.places.begin());
  if (at != list.places.end() && *at == place) {
    *counts_at = counts;
  } else {
    list.places.insert(at, place);
    list.counts.insert(counts_at, counts);
  }
}

}  // namespace fabloop
