// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

/// How far inliers spread over one image. A pose that rests on a corner of it, or on one line, may be far off elsewhere.
struct ImageSpread {
  double hull_share = 0;  ///< Share of the image inside their convex hull. A few accidental inliers do not widen it.
  double cell_share = 0;  ///< Share of the cells of a grid over the image that hold one. Lines and clusters fill few.
};

/// The same of both images.
struct InlierSpread {
  ImageSpread query, match;
};

struct InlierSpreadOptions {
  int grid_size = 8;  ///< Cells a side. Fewer where there are few features at all.
  /// Share of the points, the furthest from their middle, that the hull leaves out: those that may be inliers by accident.
  double hull_outliers = 0.1;
};

/// Of N points (pixels) in an image of the given size.
ImageSpread image_spread(std::span<const cv::Point2f> points, cv::Size image, const InlierSpreadOptions& options = {});

/// Of the inliers of a pair of views.
InlierSpread inlier_spread(const View& query, const View& match, const std::vector<Match>& inliers,
                           const InlierSpreadOptions& options = {});

}  // namespace fabloop
