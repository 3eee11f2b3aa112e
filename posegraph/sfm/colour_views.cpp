// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/colour_views.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "frontend/error.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

struct ColourView {
  View view;
  std::vector<cv::Vec3b> red_green_blue;
};

ColourView describe(const Sequence& sequence, std::size_t frame, const FeatureExtractor& extractor) {
  const cv::Mat colour = read_colour_image(sequence.frames[frame].image_path, sequence.camera);
  cv::Mat gray;
  cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
  ColourView result;
  result.view = make_view(frame, sequence.camera, extractor.extract(gray));
  for (const cv::KeyPoint& keypoint : result.view.features.keypoints) {
    const int x = std::clamp(static_cast<int>(std::lround(keypoint.pt.x)), 0, colour.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(keypoint.pt.y)), 0, colour.rows - 1);
    const auto& blue_green_red = colour.at<cv::Vec3b>(y, x);
    result.red_green_blue.emplace_back(blue_green_red[2], blue_green_red[1], blue_green_red[0]);
  }
  return result;
}

}  // namespace

ColourViews read_colour_views(const Sequence& sequence, const ColourViewsOptions& options) {
  const FeatureExtractor extractor(options.features);
  const std::size_t num_frames = sequence.frames.size();
  std::vector<std::optional<ColourView>> views(num_frames);
  std::vector<std::string> problems(num_frames);
  std::mutex progress_mutex;
  std::size_t num_done = 0;
  parallel_for(num_frames, options.num_threads, [&](std::size_t i) {
    try {
      views[i] = describe(sequence, i, extractor);
    } catch (const InputError& error) {
      if (options.if_damaged == IfDamaged::Refuse) throw;
      problems[i] = error.what();
    }
    const std::lock_guard lock(progress_mutex);
    ++num_done;
    if (options.progress) options.progress("features", num_done, num_frames);
  });
  ColourViews result;
  for (std::size_t i = 0; i < num_frames; ++i) {
    if (views[i]) {
      result.views.push_back(std::move(views[i]->view));
      result.red_green_blue.push_back(std::move(views[i]->red_green_blue));
    } else {
      if (options.warn) options.warn(problems[i] + " (skipped)");
      result.unread.push_back({i, std::move(problems[i])});
    }
  }
  if (result.views.empty()) {
    throw InputError(sequence.name + ": none of its " + std::to_string(num_frames) + " images could be read; the first: " +
                     (result.unread.empty() ? "there is none" : result.unread.front().why));
  }
  return result;
}

}  // namespace fabloop
