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
#include "posegraph/sfm/kept_work.h"
#include "posegraph/sfm/other_cameras.h"

namespace fabloop {
namespace {

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
  const std::vector<std::optional<std::string>> other = other_cameras(sequence);
  std::mutex mutex;  // of progress and state
  std::size_t num_done = 0;
  parallel_for(num_frames, options.num_threads, [&](std::size_t i) {
    if (other[i]) problems[i] = *other[i];
    if (!other[i] && options.state != nullptr) {
      const std::lock_guard lock(mutex);
      views[i] = options.state->read_as(numbered_name(kKeptView, i),
                                        [&](StateBytes& bytes) { return take_colour_view(bytes, i, sequence.camera); });
    }
    const bool is_new = !views[i] && !other[i];
    try {
      if (is_new) views[i] = describe(sequence, i, extractor);
    } catch (const InputError& error) {
      if (options.if_damaged == IfDamaged::Refuse) throw;
      problems[i] = error.what();
    }
    const std::lock_guard lock(mutex);
    if (is_new && views[i] && options.state != nullptr) options.state->write(numbered_name(kKeptView, i), bytes_of(*views[i]));
    ++num_done;
    if (options.progress) options.progress("features", num_done, num_frames);
  });
  ColourViews result;
  for (std::size_t i = 0; i < num_frames; ++i) {
    if (views[i]) {
      result.views.push_back(std::move(views[i]->view));
      result.red_green_blue.push_back(std::move(views[i]->red_green_blue));
    } else {
      if (options.warn && !other[i]) options.warn(problems[i] + " (skipped)");
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
