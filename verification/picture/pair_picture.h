// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "verification/picture/pair_report.h"
#include "verification/verifier.h"

namespace fabloop {

/// What a picture of a pair shows.
struct PictureOfPair {
  const View& query;
  const View& match;
  cv::Mat query_gray, match_gray;  ///< CV_8UC1, as large as the views' cameras.
  std::string query_name, match_name;
  const std::vector<Match>& matches;  ///< All; those that are no inliers of `found` were rejected.
  const Verification& found;
  std::vector<std::string> remarks;  ///< Lines below the verdict; long ones are wrapped.
  std::vector<PairFigure> figures;   ///< A table below them; those that are not known are left out.
};

struct PairPictureOptions {
  int image_width_px = 760;     ///< Of each of both images.
  int num_epipolar_lines = 12;  ///< So many inliers, spread over the image, show theirs.
};

/// A picture (BGR): both images side by side with the inliers as green lines and the rejected matches faintly red; below them,
/// where there is a pose with a translation, once more with some inliers and the epipolar lines of their partners (curves
/// where the lens bends them), a colour each; and the verdict with its figures.
cv::Mat draw_pair(const PictureOfPair& pair, const PairPictureOptions& options = {});

}  // namespace fabloop
