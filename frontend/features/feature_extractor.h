// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "frontend/features/feature_options.h"
#include "frontend/features/features.h"

namespace fabloop {

/// Detects and describes what one image shows. The result depends on the image and the options alone, not on the number of
/// threads.
class FeatureExtractor {
 public:
  /// Throws InputError when an option is out of range, the pairing makes no sense, or SURF is asked for and was not built in.
  explicit FeatureExtractor(const FeatureOptions& options = {});

  /// Features of an 8-bit grey image (`CV_8UC1`), at most max_features, spread evenly over it, in the order of spatially_even(). None for an
  /// image without texture or smaller than the detector's filters. Safe to call from several threads at once.
  Features extract(const cv::Mat& gray) const;

  const FeatureOptions& options() const { return options_; }

 private:
  FeatureOptions options_;
};

}  // namespace fabloop
