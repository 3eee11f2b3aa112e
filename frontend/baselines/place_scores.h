// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/baselines/image_digest.h"
#include "frontend/baselines/place_method.h"
#include "frontend/baselines/score_table.h"
#include "frontend/baselines/sequence_matching.h"
#include "frontend/fabmap/appearance_slam.h"
#include "frontend/fabmap/model.h"

namespace fabloop {

struct PlaceScoreOptions {
  /// So many of the most recent places are left out within one sequence: their views overlap the present one.
  std::size_t num_recent_excluded = 10;
  AppearanceSlamOptions slam;  ///< FAB-MAP's. Every image is a place: `revisit` stays Never.
  SequenceMatchingOptions sequence;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
};

/// How much each image looks like each place before it, by one of the methods. `images` were digested for it, and are in order of
/// time; `model` may be none for methods that need none. FAB-MAP's scores are log odds, among the places that are not excluded.
/// Throws InputError when a model is missing.
ScoreTable score_sequence(PlaceMethod method, const Model* model, const std::vector<ImageDigest>& images,
                          const PlaceScoreOptions& options = {});

/// The same of queries among the images of a map that stays as it is. Here nothing is recent.
ScoreTable score_in_map(PlaceMethod method, const Model* model, const std::vector<ImageDigest>& map,
                        const std::vector<ImageDigest>& queries, const PlaceScoreOptions& options = {});

}  // namespace fabloop
