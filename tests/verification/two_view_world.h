// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "verification/pose/relative_pose.h"
#include "verification/view.h"

namespace fabloop::testing_support {

struct TwoViewOptions {
  int num_points = 200;
  double outlier_ratio = 0;
  double noise_px = 0;
  bool planar = false;       ///< All points on one slanted plane.
  double baseline = 2.0;     ///< Metres; the points are 8 to 14 m away, in the middle two thirds of the image.
  bool fills_image = false;  ///< Points all over the match's image, 4 to 8 m away.
  bool with_points = false;  ///< The match knows the depth of its points.
  double depth_noise = 0;    ///< Relative, of those points.
  /// The pairs are sorted by a score that is better for true ones on average: two normal distributions, as far apart as two of
  /// their standard deviations, which is what ratio tests on real images give.
  bool scored = false;
  std::uint64_t seed = 1;
};

/// Two views of random points, feature i of one being feature i of the other, but for the outliers, whose pixels are random.
/// Descriptors are random and equal for a true pair, so that matching finds the pairs.
struct TwoViews {
  Pose match_from_query;  ///< Metric truth.
  View query, match;
  std::vector<RayPair> pairs;
};

Camera test_camera();
TwoViews make_two_views(const TwoViewOptions& options);

}  // namespace fabloop::testing_support
