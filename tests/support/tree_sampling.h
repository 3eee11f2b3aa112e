// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop::testing_support {

/// A connected tree over `num_words` words whose words are seen with probability about `mean_p`, parents and children together
/// more often than apart.
ChowLiuTree random_tree(std::size_t num_words, double mean_p, std::uint64_t seed);

/// Draws observations from a tree.
class TreeSampler {
 public:
  TreeSampler(const ChowLiuTree& tree, std::uint64_t seed);
  Observation draw();
  std::vector<Observation> draw(std::size_t count);

 private:
  ChowLiuTree tree_;
  std::vector<WordId> order_;
  std::mt19937_64 generator_;
};

}  // namespace fabloop::testing_support
