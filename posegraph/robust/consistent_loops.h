// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/max_clique.h"

namespace fabloop {

/// The loops that fit one another: pairwise consistency maximisation (Mangelson et al., ICRA 2018).
struct ConsistentLoops {
  std::vector<std::size_t> loops;  ///< Positions in LoopConsistency::edges(), ascending.
  bool is_proven = true;           ///< No larger set exists.
};

/// The largest set of loops each two of which are consistent; its size decides, so many false loops that agree win over few
/// right ones.
ConsistentLoops most_consistent_loops(const LoopConsistency& loops, std::size_t max_work);

/// The same, one loop at a time: what is known of earlier loops is not computed again, and the search begins with the best set so
/// far, which a new loop can make larger by no more than one.
class IncrementalConsistency {
 public:
  explicit IncrementalConsistency(std::size_t max_work = 2'000'000'000) : max_work_(max_work) {}

  /// Takes in the loops that `loops` has more than the last time; the earlier ones must be as they were.
  const ConsistentLoops& update(const LoopConsistency& loops);

  const ConsistentLoops& best() const { return best_; }

 private:
  std::size_t max_work_;
  BitGraph consistent_;
  ConsistentLoops best_;
};

}  // namespace fabloop
