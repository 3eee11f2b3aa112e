// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/sampling.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

namespace fabloop {
namespace {

/// A number of [0, count), without the bias of a plain remainder. (std::uniform_int_distribution differs among compilers.)
std::size_t random_below(std::mt19937_64& generator, std::size_t count) {
  const std::uint64_t limit = std::mt19937_64::max() - std::mt19937_64::max() % count;
  std::uint64_t value = generator();
  while (value >= limit) value = generator();
  return static_cast<std::size_t>(value % count);
}

/// The first `wanted` numbers of a random order of [0, count) (Fisher and Yates).
std::vector<std::size_t> start_of_random_order(std::size_t count, std::size_t wanted, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  wanted = std::min(wanted, count);
  std::mt19937_64 generator(seed);
  for (std::size_t i = 0; i < wanted; ++i) std::swap(order[i], order[i + random_below(generator, count - i)]);
  order.resize(wanted);
  return order;
}

}  // namespace

std::vector<std::size_t> sample_without_replacement(std::size_t count, std::size_t wanted, std::uint64_t seed) {
  std::vector<std::size_t> chosen = start_of_random_order(count, wanted, seed);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed) { return start_of_random_order(count, count, seed); }

}  // namespace fabloop
