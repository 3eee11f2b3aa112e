// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/consistent_loops.h"

namespace fabloop {
namespace {

ConsistentLoops search(const BitGraph& consistent, std::size_t max_work, std::vector<std::size_t> known) {
  MaxCliqueOptions options;
  options.max_work = max_work;
  options.known = std::move(known);
  Clique clique = max_clique(consistent, options);
  return {std::move(clique.vertices), clique.is_proven};
}

void join_consistent(const LoopConsistency& loops, std::size_t added, BitGraph& consistent) {
  for (std::size_t earlier = 0; earlier < added; ++earlier) {
    if (loops.are_consistent(earlier, added)) consistent.join(earlier, added);
  }
}

}  // namespace

ConsistentLoops most_consistent_loops(const LoopConsistency& loops, std::size_t max_work) {
  BitGraph consistent(loops.size());
  for (std::size_t k = 0; k < loops.size(); ++k) join_consistent(loops, k, consistent);
  return search(consistent, max_work, {});
}

const ConsistentLoops& IncrementalConsistency::update(const LoopConsistency& loops) {
  while (consistent_.size() < loops.size()) {
    const std::size_t added = consistent_.add_vertex();
    join_consistent(loops, added, consistent_);
    // A larger set must hold the new loop: only its neighbours matter.
    std::vector<std::size_t> neighbours;
    for (std::size_t k = 0; k < added; ++k) {
      if (consistent_.are_joined(k, added)) neighbours.push_back(k);
    }
    if (neighbours.size() + 1 <= best_.loops.size()) continue;
    BitGraph around(neighbours.size());
    for (std::size_t a = 0; a < neighbours.size(); ++a) {
      for (std::size_t b = a + 1; b < neighbours.size(); ++b) {
        if (consistent_.are_joined(neighbours[a], neighbours[b])) around.join(a, b);
      }
    }
    ConsistentLoops found = search(around, max_work_, {});
    best_.is_proven = best_.is_proven && found.is_proven;
    if (found.loops.size() + 1 <= best_.loops.size()) continue;
    best_.loops.clear();
    for (const std::size_t k : found.loops) best_.loops.push_back(neighbours[k]);
    best_.loops.push_back(added);
  }
  return best_;
}

}  // namespace fabloop
