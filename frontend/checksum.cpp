// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/checksum.h"

#include <cstring>

namespace fabloop {

std::uint64_t checksum(std::string_view bytes) {
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  std::uint64_t hash = 14695981039346656037ULL ^ bytes.size();
  std::size_t i = 0;
  for (; i + sizeof(std::uint64_t) <= bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, sizeof(word));
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32;  // the upper bytes of a word would never reach the lower bits
  }
  for (; i < bytes.size(); ++i) hash = (hash ^ static_cast<unsigned char>(bytes[i])) * kPrime;
  return hash;
}

}  // namespace fabloop
