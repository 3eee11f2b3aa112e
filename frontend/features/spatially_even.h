// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/features.h"

namespace fabloop {

/// Indices of at most `wanted` keypoints that cover the image evenly, and of which the first n do so, for any n.
///
/// The image is divided into about `wanted` / 16 square cells. The strongest spot of every cell is taken first, then the second
/// of every cell, and so on (in each turn by response; ties by index), so that a rich corner gives what poor cells lack and no
/// cell starves. A spot is what one detection gave: SIFT's keypoints that share place, scale and response and differ by
/// orientation alone. It takes one turn in its cell and is kept whole or not at all, while each of its keypoints counts towards
/// `wanted`. Keypoints may lie outside the image; they belong to the nearest cell.
std::vector<std::size_t> spatially_even(const std::vector<cv::KeyPoint>& keypoints, const cv::Size& image_size,
                                        std::size_t wanted);

/// The first `count` features (all where there are fewer), which cover the image evenly where an extractor gave them. Shares the
/// descriptors' memory.
Features first_features(const Features& features, std::size_t count);

}  // namespace fabloop
