// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pair_seed.h"

#include <initializer_list>

namespace fabloop {

std::uint64_t pair_seed(std::uint64_t seed, std::size_t query, std::size_t match) {
  std::uint64_t state = seed;
  for (const std::uint64_t value : {static_cast<std::uint64_t>(query), static_cast<std::uint64_t>(match)}) {
    state += 0x9e3779b97f4a7c15 + value;  // splitmix64 (Steele et al. 2014)
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9;
    state = (state ^ (state >> 27)) * 0x94d049bb133111eb;
    state ^= state >> 31;
  }
  return state;
}

}  // namespace fabloop
