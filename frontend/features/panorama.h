// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "frontend/features/feature_extractor.h"

namespace fabloop {

/// Features of a grey image (`CV_8UC1`) that shows all 360 degrees, its left edge next to its right one. The image is continued
/// on both sides by the columns of the other, so that the seam is like any other place, and what lies in the continuation is
/// dropped, since it is found on the other side. Otherwise as FeatureExtractor::extract.
Features extract_panorama(const FeatureExtractor& extractor, const cv::Mat& gray);

/// Whether an image ends at its left and right edges.
enum class ImageShape {
  Plain,
  Panorama,  ///< 360 degrees: the edges are neighbours.
};

/// The features of a grey image of that shape.
Features extract(const FeatureExtractor& extractor, const cv::Mat& gray, ImageShape shape);

}  // namespace fabloop
