// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/detectors.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "frontend/features/mser_detector.h"
#include "frontend/features/star_detector.h"
#include "frontend/features/surf.h"

namespace fabloop {
namespace {

/// ORB bounds its own count by strength alone, so it is asked for a surplus from which the even selection chooses.
constexpr int kOrbSurplus = 5;

int grey_levels(double threshold) { return static_cast<int>(std::lround(std::min(threshold, 255.0))); }

cv::Ptr<cv::Feature2D> make_orb(const FeatureOptions& options, double threshold) {
  const int wanted = std::max(options.max_features, options.adaptive ? options.adaptive->max_features : 0);
  constexpr int kFirstLevel = 0, kPointsCompared = 2;
  const OrbOptions& orb = options.orb;
  return cv::ORB::create(kOrbSurplus * wanted, static_cast<float>(orb.scale_factor), orb.num_levels, orb.patch_size_px,
                         kFirstLevel, kPointsCompared, cv::ORB::HARRIS_SCORE, orb.patch_size_px, grey_levels(threshold));
}

cv::Ptr<cv::Feature2D> make_akaze(const FeatureOptions& options, double threshold) {
  const auto descriptor =
      options.orientation == Orientation::Upright ? cv::AKAZE::DESCRIPTOR_MLDB_UPRIGHT : cv::AKAZE::DESCRIPTOR_MLDB;
  constexpr int kFullSize = 0, kChannels = 3;
  return cv::AKAZE::create(descriptor, kFullSize, kChannels, static_cast<float>(threshold), options.akaze.num_octaves,
                           options.akaze.layers_per_octave);
}

cv::Ptr<cv::Feature2D> make_kaze(const FeatureOptions& options, double threshold) {
  constexpr bool kExtended = false;
  return cv::KAZE::create(kExtended, options.orientation == Orientation::Upright, static_cast<float>(threshold),
                          options.kaze.num_octaves, options.kaze.layers_per_octave);
}

/// Corners with their quality, which OpenCV's own GFTTDetector does not tell.
std::vector<cv::KeyPoint> detect_gftt(const cv::Mat& image, const GfttOptions& options, double threshold) {
  constexpr double kLeastShare = 1e-6;  // OpenCV takes no zero
  constexpr int kNoBound = 0;
  std::vector<cv::Point2f> corners;
  std::vector<float> qualities;
  cv::goodFeaturesToTrack(image, corners, kNoBound, std::clamp(threshold, kLeastShare, 1.0), options.min_distance_px,
                          cv::noArray(), qualities, options.block_size_px);
  constexpr float kSize = 7.0F;  // as FAST's circle: what is described must not depend on the block
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    keypoints.emplace_back(corners[i], kSize, -1.0F, qualities[i] / qualities.front());
  }
  return keypoints;
}

}  // namespace

cv::Ptr<cv::Feature2D> make_opencv_detector(const FeatureOptions& options, double threshold) {
  switch (options.kind.detector) {
    case DetectorKind::Sift: {
      constexpr int kNoBound = 0;
      return cv::SIFT::create(kNoBound, options.sift.layers_per_octave, threshold, options.sift.edge_threshold,
                              options.sift.sigma);
    }
    case DetectorKind::Orb:
      return make_orb(options, threshold);
    case DetectorKind::Brisk:
      return cv::BRISK::create(std::max(1, grey_levels(threshold)), options.brisk.num_octaves,
                               static_cast<float>(options.brisk.pattern_scale));
    case DetectorKind::Akaze:
      return make_akaze(options, threshold);
    case DetectorKind::Kaze:
      return make_kaze(options, threshold);
    case DetectorKind::Fast:
      return cv::FastFeatureDetector::create(grey_levels(threshold), options.fast.non_max_suppression);
    case DetectorKind::Agast:
      return cv::AgastFeatureDetector::create(grey_levels(threshold), options.agast.non_max_suppression);
    case DetectorKind::Surf:
    case DetectorKind::Star:
    case DetectorKind::Mser:
    case DetectorKind::Gftt:
      break;
  }
  return {};
}

int least_image_side(DetectorKind kind) {
  switch (kind) {
    case DetectorKind::Sift:
      return 1;
    case DetectorKind::Akaze:
    case DetectorKind::Kaze:
    case DetectorKind::Brisk:
    case DetectorKind::Orb:
      return 32;
    default:
      return 8;
  }
}

std::vector<cv::KeyPoint> detect(const cv::Mat& image, const FeatureOptions& options, double threshold) {
  std::vector<cv::KeyPoint> keypoints;
  if (std::min(image.rows, image.cols) < least_image_side(options.kind.detector)) return keypoints;
  switch (options.kind.detector) {
    case DetectorKind::Surf:
      return detect_surf(image, options.surf, threshold);
    case DetectorKind::Star:
      return detect_star(image, options.star, threshold);
    case DetectorKind::Mser:
      return detect_mser(image, options.mser, threshold);
    case DetectorKind::Gftt:
      return detect_gftt(image, options.gftt, threshold);
    default:
      make_opencv_detector(options, threshold)->detect(image, keypoints);
      return keypoints;
  }
}

float spot_size(DetectorKind kind, const cv::KeyPoint& keypoint) {
  constexpr float kOrbPatchPerSpot = 6.0F;
  if (kind == DetectorKind::Orb) return keypoint.size / kOrbPatchPerSpot;
  if (kind == DetectorKind::Brisk) return keypoint.size * static_cast<float>(kSpotPerBriskSize);
  return keypoint.size;
}

}  // namespace fabloop
