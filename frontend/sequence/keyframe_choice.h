// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

struct KeyframeChoiceOptions {
  /// A keyframe is the first image that shares no more than this part of its area with the keyframe before it.
  double max_overlap = 0.85;
  /// It comes earlier when fewer of the last keyframe's corners than this part are still followed: parallax of a deep scene,
  /// something in the way, a change of light.
  double min_followed = 0.5;
};

/// Chooses keyframes among the images of a video: neighbours that show nearly the same are left out, and none that is needed to
/// follow the scene. Corners of the last keyframe are followed from image to image (Lucas-Kanade, there and back); the affine map
/// that most of them obey says how much of the picture is shared. No unit of length and no calibration is asked for.
class KeyframeChoice {
 public:
  /// Throws InputError for shares that are not above 0 and below 1.
  explicit KeyframeChoice(const KeyframeChoiceOptions& options = {});

  /// Whether the next image (`CV_8UC1`, of any one size) is a keyframe. The first is, and so is one after which nothing can be
  /// followed.
  bool takes(const cv::Mat& gray);

  /// Part of its area that the image last asked about shares with the keyframe before it, in the one of the two where it is less;
  /// 0 for the first and where nothing could be followed.
  double overlap() const { return overlap_; }

 private:
  void begin_at(const cv::Mat& image);
  void follow(const cv::Mat& image);
  double shared_area(cv::Size size) const;

  KeyframeChoiceOptions options_;
  cv::Mat last_;                          ///< The image before, at working size.
  std::vector<cv::Point2f> in_keyframe_;  ///< Corners that are still followed, where they were in the last keyframe,
  std::vector<cv::Point2f> in_last_;      ///< and where they are in the image before.
  std::size_t num_corners_ = 0;           ///< Of the last keyframe.
  double overlap_ = 0;
};

}  // namespace fabloop
