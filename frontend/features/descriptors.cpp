// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/descriptors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "frontend/features/detectors.h"
#include "frontend/features/dominant_angle.h"
#include "frontend/features/surf.h"

namespace fabloop {
namespace {

/// What a descriptor looks at, in spots: SIFT's four cells of three scales each, a spot being two scales across.
constexpr double kWindowPerSpot = 6.0;

/// SIFT's descriptor reads the scale space at the octave and layer that a keypoint names, packed into one number.
int sift_octave(double size, const cv::Size& image, const SiftOptions& options) {
  const double sigma = std::max(size / 2.0, options.sigma);
  const int layers = options.layers_per_octave;
  const int total = static_cast<int>(std::lround(layers * std::log2(sigma / options.sigma)));
  const int most_octaves = std::max(0, static_cast<int>(std::log2(std::min(image.width, image.height))) - 3);
  const int octave = std::min(total / layers, most_octaves);
  return octave | (total - octave * layers < layers ? total % layers : layers - 1) << 8;
}

/// ORB's descriptor has one size a level of its pyramid.
int orb_level(double size, const cv::Size& image, const OrbOptions& options) {
  const double per_level = std::log(options.scale_factor);
  const int wanted = static_cast<int>(std::lround(std::log(kWindowPerSpot * size / options.patch_size_px) / per_level));
  const double most = std::log(std::min(image.width, image.height) / 16.0) / per_level;
  return std::clamp(wanted, 0, std::max(0, std::min(options.num_levels - 1, static_cast<int>(most))));
}

/// BRISK's pattern reaches so many sizes far with its smoothing.
constexpr double kBriskReach = 1.54;

/// Large spots would need more than the image has: the pattern takes at most half of it.
float brisk_size(double size, const cv::Size& image) {
  const double most = std::min(image.width, image.height) / 4.0 / kBriskReach;
  return static_cast<float>(std::min(most, size / kSpotPerBriskSize));
}

bool is_own(const FeatureKind& kind) { return to_string(kind.detector) == to_string(kind.descriptor); }

/// Gives keypoints the angle that the descriptor goes by.
void set_angles(const cv::Mat& image, const FeatureOptions& options, std::vector<cv::KeyPoint>& keypoints) {
  if (options.orientation == Orientation::Upright) {
    for (cv::KeyPoint& keypoint : keypoints) keypoint.angle = 0;
    return;
  }
  const auto has_none = [](const cv::KeyPoint& keypoint) { return keypoint.angle < 0; };
  if (std::none_of(keypoints.begin(), keypoints.end(), has_none)) return;
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, {}, options.sift.sigma);
  for (cv::KeyPoint& keypoint : keypoints) {
    if (has_none(keypoint)) keypoint.angle = dominant_angle(blurred, keypoint.pt, spot_size(options.kind.detector, keypoint));
  }
}

/// The keypoints as another detector's descriptor expects its own.
std::vector<cv::KeyPoint> translated(const std::vector<cv::KeyPoint>& keypoints, const cv::Size& image,
                                     const FeatureOptions& options) {
  std::vector<cv::KeyPoint> result = keypoints;
  for (cv::KeyPoint& keypoint : result) {
    keypoint.size = spot_size(options.kind.detector, keypoint);
    const double size = keypoint.size;
    switch (options.kind.descriptor) {
      case DescriptorKind::Sift:
        keypoint.octave = sift_octave(size, image, options.sift);
        break;
      case DescriptorKind::Orb:
        keypoint.octave = orb_level(size, image, options.orb);
        break;
      case DescriptorKind::Brisk:
        keypoint.size = brisk_size(size, image);
        break;
      default:
        break;
    }
  }
  return result;
}

/// The descriptor's own extractor.
cv::Ptr<cv::Feature2D> make_extractor(const FeatureOptions& options) {
  FeatureOptions own = options;
  const auto kind = feature_kind_from_string(to_string(options.kind.descriptor));
  own.kind = *kind;
  own.max_features = std::max(options.max_features, 1);
  return make_opencv_detector(own, detection_threshold(options));
}

/// Lets OpenCV describe `theirs`, which stand for `keypoints`. It drops what is too near the edge, and ORB changes the order.
Features compute(const cv::Mat& image, const FeatureOptions& options, const std::vector<cv::KeyPoint>& keypoints,
                 std::vector<cv::KeyPoint> theirs) {
  for (std::size_t i = 0; i < theirs.size(); ++i) theirs[i].class_id = static_cast<int>(i);
  cv::Mat rows;
  make_extractor(options)->compute(image, theirs, rows);
  std::vector<std::size_t> order(theirs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return theirs[a].class_id < theirs[b].class_id; });
  Features features;
  features.descriptors.create(static_cast<int>(theirs.size()), descriptor_layout(options.kind.descriptor).size,
                              descriptor_layout(options.kind.descriptor).cv_type);
  for (const std::size_t i : order) {
    rows.row(static_cast<int>(i)).copyTo(features.descriptors.row(static_cast<int>(features.keypoints.size())));
    features.keypoints.push_back(keypoints[static_cast<std::size_t>(theirs[i].class_id)]);
    features.keypoints.back().angle = theirs[i].angle;
  }
  return features;
}

/// Without angles, what differed by them alone is one keypoint.
void drop_repeats(std::vector<cv::KeyPoint>& keypoints) {
  const auto last = std::unique(keypoints.begin(), keypoints.end(), [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    return a.pt == b.pt && a.size == b.size && a.octave == b.octave && a.response == b.response;
  });
  keypoints.erase(last, keypoints.end());
}

void turn_into_root_sift(cv::Mat& descriptors) {
  for (int row = 0; row < descriptors.rows; ++row) {
    cv::Mat descriptor = descriptors.row(row);
    const double sum = cv::norm(descriptor, cv::NORM_L1);
    if (sum > 0) descriptor /= sum;
  }
  cv::sqrt(descriptors, descriptors);
}

Features describe_kind(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints, const FeatureOptions& options) {
  if (options.orientation == Orientation::Upright) drop_repeats(keypoints);
  const bool own = is_own(options.kind);
  switch (options.kind.descriptor) {
    case DescriptorKind::Surf: {
      Features features;
      std::vector<cv::KeyPoint> theirs = own ? keypoints : translated(keypoints, image.size(), options);
      features.descriptors = describe_surf(image, theirs, options.orientation);
      for (std::size_t i = 0; i < keypoints.size(); ++i) keypoints[i].angle = theirs[i].angle;
      features.keypoints = std::move(keypoints);
      return features;
    }
    case DescriptorKind::Sift:
    case DescriptorKind::Orb:
      set_angles(image, options, keypoints);
      break;
    default:
      break;
  }
  // OpenCV's others take their own keypoints as they are, and keep the order; KAZE's and AKAZE's class is their layer.
  if (own && options.kind.descriptor != DescriptorKind::Orb) {
    Features features;
    features.keypoints = std::move(keypoints);
    make_extractor(options)->compute(image, features.keypoints, features.descriptors);
    return features;
  }
  return compute(image, options, keypoints, own ? keypoints : translated(keypoints, image.size(), options));
}

}  // namespace

void erase_undescribable(std::vector<cv::KeyPoint>& keypoints, const cv::Size& image, const FeatureOptions& options) {
  const DescriptorKind kind = options.kind.descriptor;
  if (is_own(options.kind) || (kind != DescriptorKind::Orb && kind != DescriptorKind::Brisk)) return;
  std::erase_if(keypoints, [&](const cv::KeyPoint& keypoint) {
    const double size = brisk_size(spot_size(options.kind.detector, keypoint), image);
    const double brisk_reach = kBriskReach * options.brisk.pattern_scale * size + 2.0;
    const double margin = kind == DescriptorKind::Orb ? options.orb.patch_size_px : brisk_reach;
    return keypoint.pt.x < margin || keypoint.pt.y < margin || keypoint.pt.x >= image.width - margin ||
           keypoint.pt.y >= image.height - margin;
  });
}

Features describe(const cv::Mat& image, std::vector<cv::KeyPoint> keypoints, const FeatureOptions& options) {
  Features features;
  if (!keypoints.empty()) features = describe_kind(image, keypoints, options);
  features.descriptor_kind = options.kind.descriptor;
  if (options.orientation == Orientation::Upright) {
    for (cv::KeyPoint& keypoint : features.keypoints) keypoint.angle = 0;  // AKAZE's keep theirs
  }
  const DescriptorLayout layout = descriptor_layout(options.kind.descriptor);
  if (features.keypoints.empty()) features.descriptors.create(0, layout.size, layout.cv_type);
  if (options.kind.descriptor == DescriptorKind::Sift && options.root_sift) turn_into_root_sift(features.descriptors);
  return features;
}

}  // namespace fabloop
