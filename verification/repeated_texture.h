// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

/// How far matches could be confused with others: rows of crops, tiles and windows look alike, and a pose from them may be off
/// by a step of the pattern. All figures are 0 on texture that does not repeat.
struct RepeatedTexture {
  /// Share of the matches whose spot in the match view is another one's as well: many features of the query want one spot.
  double many_to_one_share = 0;
  /// Other spots of the match view that look nearly as much like the query's feature as its match does, in the mean a match.
  /// Matches that passed a sharper ratio test than `near_ratio` have none.
  double mean_num_rivals = 0;
  /// Share of the matches whose feature in the match view has a look-alike in its own image, at another spot, nearer to it
  /// than the query's feature is: by appearance alone the match could as well be that one.
  double lookalike_share = 0;
};

struct RepeatedTextureOptions {
  double near_ratio = 0.9;  ///< Rivals are up to 1 / near_ratio times as far as the match.
  /// Features closer than this show one spot, in pixels of the image in which they were found; wider than matching's, for one
  /// pattern at two scales.
  double same_spot_px = 4.0;
  int max_matches = 200;  ///< So many, evenly chosen, are compared with the whole match view: a bound on the time.
};

/// Of matches of two views: the inliers, say.
RepeatedTexture repeated_texture(const View& query, const View& match, const std::vector<Match>& matches,
                                 const RepeatedTextureOptions& options = {});

}  // namespace fabloop
