// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/posting_block.h"

#include <cassert>

namespace fabloop {

void PostingBlock::add_place(std::span<const WordId> words) {
  assert(!open_.empty() && num_places_ < kCapacity);
  const auto place = static_cast<Position>(num_places_++);
  for (const WordId word : words) open_[word].push_back(place);
}

void PostingBlock::seal() {
  begin_.reserve(open_.size() + 1);
  begin_.push_back(0);
  for (const auto& places : open_) begin_.push_back(begin_.back() + static_cast<std::uint32_t>(places.size()));
  packed_.reserve(begin_.back());
  for (const auto& places : open_) packed_.insert(packed_.end(), places.begin(), places.end());
  open_ = {};
}

}  // namespace fabloop
