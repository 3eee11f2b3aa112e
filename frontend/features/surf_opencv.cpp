// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/xfeatures2d/nonfree.hpp>

#include "frontend/features/surf.h"

namespace fabloop {
namespace {

/// OpenCV's size is the filter's width, 9 / 1.2 scales; ours is a scale over 0.3.
constexpr float kOurSizePerOpenCvs = 1.2F / 9.0F / 0.3F;

constexpr double kReach = 15.5;  ///< Of a descriptor from its centre, in scales.

constexpr int kLeastSide = 32;  ///< Below it no filter fits.

}  // namespace

std::string_view surf_library() { return "opencv"; }

void require_surf() {}

std::vector<cv::KeyPoint> detect_surf(const cv::Mat& gray, const SurfOptions& options, double threshold) {
  if (std::min(gray.rows, gray.cols) < kLeastSide) return {};
  const auto surf = cv::xfeatures2d::SURF::create(threshold, options.num_octaves, options.layers_per_octave);
  surf->setUpright(true);  // angles are found when a keypoint is described
  std::vector<cv::KeyPoint> keypoints;
  surf->detect(gray, keypoints);
  for (cv::KeyPoint& keypoint : keypoints) {
    keypoint.size *= kOurSizePerOpenCvs;
    keypoint.angle = -1;
  }
  return keypoints;
}

cv::Mat describe_surf(const cv::Mat& gray, std::vector<cv::KeyPoint>& keypoints, Orientation orientation) {
  cv::Mat descriptors(static_cast<int>(keypoints.size()), 64, CV_32F, cv::Scalar(0));
  if (keypoints.empty()) return descriptors;
  float largest = 0;
  for (const cv::KeyPoint& keypoint : keypoints) largest = std::max(largest, keypoint.size);
  const int padding = cvCeil(kReach * std::max(1.0, 0.3 * largest)) + 4;
  cv::Mat padded;
  cv::copyMakeBorder(gray, padded, padding, padding, padding, padding, cv::BORDER_REPLICATE);
  // OpenCV drops keypoints that it cannot turn, so that they are told apart by their class.
  std::vector<cv::KeyPoint> theirs = keypoints;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    theirs[i].pt += cv::Point2f(static_cast<float>(padding), static_cast<float>(padding));
    theirs[i].size = std::max(theirs[i].size, 1.0F / 0.3F) / kOurSizePerOpenCvs;
    theirs[i].class_id = static_cast<int>(i);
  }
  const auto surf = cv::xfeatures2d::SURF::create();
  surf->setUpright(orientation == Orientation::Upright);
  cv::Mat rows;
  surf->compute(padded, theirs, rows);
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const auto index = static_cast<std::size_t>(theirs[i].class_id);
    keypoints[index].angle = orientation == Orientation::Upright ? 0 : theirs[i].angle;
    rows.row(static_cast<int>(i)).copyTo(descriptors.row(static_cast<int>(index)));
  }
  return descriptors;
}

}  // namespace fabloop
