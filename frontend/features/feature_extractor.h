// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string_view>

#include "frontend/features/features.h"

namespace fabloop {

/// What to detect, how much of it, and how the image is prepared.
struct FeatureOptions {
  /// SIFT finds the most true matches on low-contrast ground; ORB is several times faster and its descriptors 16 times smaller.
  FeatureKind kind = FeatureKind::Sift;
  /// Upper bound of keypoints an image. More finds weaker overlaps; time and memory of matching grow with it.
  int max_features = 1500;
  /// Weakest response that is still detected: SIFT's contrast threshold, ORB's FAST threshold (grey levels), AKAZE's Hessian
  /// threshold. None: default_detection_threshold(kind), low, so that poor texture still yields features and the even selection
  /// drops the weak ones elsewhere. Higher is faster, and better where sensor noise yields features.
  std::optional<double> detection_threshold;
  /// Clip limit of the local contrast equalisation (CLAHE, Zuiderveld 1994) before detection. Higher brings out fainter texture
  /// and more noise. None leaves the image as it is: for evenly lit, well exposed images, or already equalised ones.
  std::optional<double> clahe_clip_limit = 1.5;
  /// Whether SIFT's descriptors are turned into RootSIFT (Arandjelovic and Zisserman, CVPR 2012): divided by their sum, then the
  /// square root, so that Euclidean distance compares them as histograms. False gives OpenCV's values in [0, 255], which a
  /// vocabulary trained elsewhere may expect.
  bool root_sift = true;
};

/// The detection threshold used when none is given.
double default_detection_threshold(FeatureKind kind);

/// Detects and describes what one image shows. The result depends on the image and the options alone, not on the number of
/// threads.
class FeatureExtractor {
 public:
  /// Throws InputError when an option is out of range.
  explicit FeatureExtractor(const FeatureOptions& options = {});

  /// Features of an 8-bit grey image (`CV_8UC1`), at most max_features, spread evenly over it, the strongest first. None for an
  /// image without texture. Safe to call from several threads at once.
  Features extract(const cv::Mat& gray) const;

  const FeatureOptions& options() const { return options_; }

 private:
  FeatureOptions options_;
};

/// "sift", "orb" or "akaze": the names used in options and files.
std::string_view to_string(FeatureKind kind);

/// The inverse of to_string; none for any other text.
std::optional<FeatureKind> feature_kind_from_string(std::string_view name);

}  // namespace fabloop
