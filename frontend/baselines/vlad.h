// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

#include "frontend/fabmap/vocabulary.h"

namespace fabloop {

struct VladOptions {
  std::size_t num_centres = 64;  ///< More tell places apart better, and make vectors longer (centres times descriptor).
  std::uint64_t seed = 1;        ///< Of the clustering.
};

/// The few centres that VLAD takes residuals from: the vocabulary's words, clustered once more (k-means). K x D.
Vocabulary vlad_centres(const Vocabulary& vocabulary, const VladOptions& options = {});

/// Vector of locally aggregated descriptors: for each centre the sum of the differences of the descriptors nearest to it (Jegou
/// et al., Aggregating local descriptors into a compact image representation, CVPR 2010, eq. 1), each scaled to unit length, and
/// then the whole (Arandjelovic & Zisserman, All about VLAD, CVPR 2013: intra-normalisation). 1 x K D, CV_32F; all zero for no
/// descriptors. Packed bits count as numbers 0 and 1. Throws InputError for descriptors of another length than the centres'.
cv::Mat vlad_of(const Vocabulary& centres, const cv::Mat& descriptors);

/// How alike two images are: the cosine of their vectors, in [-1, 1].
double vlad_score(const cv::Mat& a, const cv::Mat& b);

}  // namespace fabloop
