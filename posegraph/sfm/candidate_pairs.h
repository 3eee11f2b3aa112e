// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/progress.h"
#include "verification/view.h"

namespace fabloop {

struct CandidatePairsOptions {
  /// So many images before and after each are compared with it. More for video rates, where near images share no parallax.
  std::size_t num_neighbours = 6;
  /// So many of the places that FAB-MAP holds most probable, neighbours aside. More where strips overlap often.
  std::size_t num_hypotheses = 20;
  /// Only where positions are given: so many of the nearest ones, too.
  std::size_t num_nearest = 0;
  std::size_t num_training_features = 800;  ///< Of each image, for words and their model. More is slower.
  std::uint64_t seed = 1;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  Progress progress;
};

/// Two views that may overlap; `match` comes before `query`.
struct CandidatePair {
  std::size_t query = 0;
  std::size_t match = 0;
  friend auto operator<=>(const CandidatePair&, const CandidatePair&) = default;
};

/// Pairs worth comparing, in ascending order: neighbours in time, and what FAB-MAP (Cummins & Newman 2008) takes for one place
/// when every view asks among all the others. Without a model one is trained on the views themselves. `positions` (of each view,
/// where known) add the nearest ones when asked to.
std::vector<CandidatePair> candidate_pairs(const std::vector<View>& views, const std::optional<Model>& model,
                                           const std::vector<std::optional<Eigen::Vector3d>>& positions,
                                           const CandidatePairsOptions& options = {});

}  // namespace fabloop
