// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/keyframe_choice.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>

#include "frontend/error.h"
#include "frontend/within_side.h"

namespace fabloop {
namespace {

/// Images are looked at with this longer side: overlaps need no more, and small images are fast.
constexpr int kWorkingSide = 480;
constexpr int kMaxCorners = 300;
/// Fewer corners say nothing about the whole picture.
constexpr std::size_t kMinCorners = 12;

std::vector<cv::Point2f> corners_of(const cv::Mat& image) {
  constexpr double kQuality = 0.01, kMinDistance = 10;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, kMaxCorners, kQuality, kMinDistance);
  return corners;
}

std::vector<cv::Point2f> outline(cv::Size size) {
  const auto w = static_cast<float>(size.width), h = static_cast<float>(size.height);
  return {{0, 0}, {w, 0}, {w, h}, {0, h}};
}

void require_share(double share, const char* what) {
  if (!(share > 0.0 && share < 1.0)) throw InputError(std::string(what) + " must be above 0 and below 1");
}

}  // namespace

KeyframeChoice::KeyframeChoice(const KeyframeChoiceOptions& options) : options_(options) {
  require_share(options.max_overlap, "the largest overlap of keyframes");
  require_share(options.min_followed, "the least part of corners that are followed");
}

bool KeyframeChoice::takes(const cv::Mat& gray) {
  const cv::Mat image = within_side(gray, kWorkingSide).clone();  // the caller may use its own again
  overlap_ = 0;
  if (!last_.empty() && last_.size() == image.size() && num_corners_ >= kMinCorners) {
    follow(image);
    const double followed = static_cast<double>(in_last_.size()) / static_cast<double>(num_corners_);
    if (in_last_.size() >= kMinCorners) overlap_ = shared_area(image.size());
    if (overlap_ > options_.max_overlap && followed >= options_.min_followed) {
      last_ = image;
      return false;
    }
  }
  begin_at(image);
  return true;
}

void KeyframeChoice::begin_at(const cv::Mat& image) {
  last_ = image;
  in_keyframe_ = in_last_ = corners_of(image);
  num_corners_ = in_last_.size();
}

void KeyframeChoice::follow(const cv::Mat& image) {
  if (in_last_.empty()) return;
  std::vector<cv::Point2f> there, back;
  std::vector<unsigned char> found_there, found_back;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(last_, image, in_last_, there, found_there, errors);
  cv::calcOpticalFlowPyrLK(image, last_, there, back, found_back, errors);
  constexpr double kMaxReturnPx = 1.0;
  const cv::Rect2f inside({0, 0}, cv::Size2f(image.size()));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    if (!found_there[i] || !found_back[i] || !inside.contains(there[i]) || cv::norm(back[i] - in_last_[i]) > kMaxReturnPx)
      continue;
    in_keyframe_[kept] = in_keyframe_[i];
    in_last_[kept++] = there[i];
  }
  in_keyframe_.resize(kept);
  in_last_.resize(kept);
}

double KeyframeChoice::shared_area(cv::Size size) const {
  constexpr double kMaxErrorPx = 3.0;
  const cv::Mat map = cv::estimateAffine2D(in_keyframe_, in_last_, cv::noArray(), cv::RANSAC, kMaxErrorPx);
  if (map.empty()) return 0;
  std::vector<cv::Point2f> keyframe, shared;
  cv::transform(outline(size), keyframe, map);
  const double magnification = map.at<double>(0, 0) * map.at<double>(1, 1) - map.at<double>(0, 1) * map.at<double>(1, 0);
  if (!(magnification > 0.0)) return 0;
  const double area = cv::intersectConvexConvex(outline(size), keyframe, shared) / static_cast<double>(size.area());
  return std::min(area, area / magnification);
}

}  // namespace fabloop
