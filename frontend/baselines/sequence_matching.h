// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// The parameters of Milford & Wyeth, SeqSLAM, ICRA 2012 (table I), with its defaults.
struct SequenceMatchingOptions {
  int width_px = 64, height_px = 32;  ///< Of the small images. The sides must be multiples of the patch's.
  int patch_px = 8;                   ///< Side of the squares that are normalised.
  std::size_t contrast_window = 10;   ///< Places over which differences are compared with one another: R_window.
  std::size_t length = 10;            ///< Images in a sequence: d_s. Longer ones are surer, and need longer revisits.
  /// Speeds that are tried, in places of the map an image. Wider where the routes were travelled at different speeds.
  double min_speed = 0.8, max_speed = 1.2;
  double speed_step = 0.1;
};

/// An image made small, each patch with mean 0 and standard deviation 1 (0 where it is of one grey). CV_32F. `gray` is CV_8UC1.
/// Throws InputError for sides that are no multiples of the patch's.
cv::Mat1f small_image(const cv::Mat& gray, const SequenceMatchingOptions& options = {});

/// Rows of different lengths, one a query: entry j is of place j.
using DifferenceRows = std::vector<std::vector<float>>;

/// How much sequences of images look alike (Milford & Wyeth 2012). `differences` has the mean absolute difference of the small
/// images of each query and all places that there were, the queries in their order. Within each row, a difference is compared
/// with those of the places around (eq. 2: less their mean, over their standard deviation); a score is minus the least mean of
/// such numbers along straight lines of the possible speeds that end at query and place. Minus infinity where no such line fits:
/// for the first `length` - 1 queries, and for the first round(`min_speed` * (`length` - 1)) places. Only the same direction of
/// travel is looked for, as in the paper. One row a query, as long as its differences. Throws InputError for options that make no
/// sense.
std::vector<std::vector<double>> sequence_scores(const DifferenceRows& differences, const SequenceMatchingOptions& options = {});

}  // namespace fabloop
