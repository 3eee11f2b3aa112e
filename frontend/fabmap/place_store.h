// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/place_model.h"

namespace fabloop {

/// The models of many places in little memory: gaps between ascending words, and detections only where a place was visited
/// more than once, as numbers of variable length. About one byte a word.
class PlaceStore {
 public:
  std::size_t size() const { return places_.size(); }
  std::uint32_t visits(PlaceId place) const { return visits_[place]; }
  PlaceModel operator[](PlaceId place) const;

  void push_back(const PlaceModel& place);
  void set(PlaceId place, const PlaceModel& model);

  /// Calls `visit(word, detections)` for each word of the place, ascending.
  template <typename Visitor>
  void for_each_word(PlaceId place, Visitor&& visit) const {
    const std::uint8_t* byte = places_[place].data();
    const std::uint8_t* const end = byte + places_[place].size();
    const bool has_detections = visits_[place] > 1;
    WordId word = 0;
    for (bool is_first = true; byte != end; is_first = false) {
      word += read_number(byte) + (is_first ? 0 : 1);
      visit(word, has_detections ? read_number(byte) : 1u);
    }
  }

 private:
  static std::uint32_t read_number(const std::uint8_t*& byte) {
    std::uint32_t number = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint32_t bits = *byte++;
      number |= (bits & 0x7Fu) << shift;
      if (bits < 0x80u) return number;
    }
  }

  std::vector<std::vector<std::uint8_t>> places_;
  std::vector<std::uint32_t> visits_;
};

}  // namespace fabloop
