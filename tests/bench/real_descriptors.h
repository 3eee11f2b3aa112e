// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fabloop::bench {

/// RootSIFT of real aerial images, and words made of it.
struct RealDescriptors {
  cv::Mat words;    ///< 10,000 x 128.
  cv::Mat queries;  ///< N x 128, of images that the words were not made of.
};

/// Made once, in about a minute. Empty where the images are absent.
const RealDescriptors& real_descriptors();

}  // namespace fabloop::bench
