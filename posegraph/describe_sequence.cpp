// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/describe_sequence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

std::vector<std::uint8_t> grey_at_keypoints(const cv::Mat& gray, const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<std::uint8_t> grey;
  grey.reserve(keypoints.size());
  for (const auto& keypoint : keypoints) {
    const int x = std::clamp(static_cast<int>(std::lround(keypoint.pt.x)), 0, gray.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(keypoint.pt.y)), 0, gray.rows - 1);
    grey.push_back(gray.at<std::uint8_t>(y, x));
  }
  return grey;
}

DescribedFrame describe(const Sequence& sequence, std::size_t frame, const FeatureExtractor& extractor) {
  DescribedFrame described;
  described.frame = frame;
  const auto start = Clock::now();
  const cv::Mat gray = read_gray_image(sequence.frames[frame].image_path, sequence.camera);
  const auto read = Clock::now();
  described.features = extractor.extract(gray);
  described.read_s = seconds_between(start, read);
  described.describe_s = seconds_between(read, Clock::now());
  described.grey = grey_at_keypoints(gray, described.features.keypoints);
  return described;
}

}  // namespace

DescribedSequence describe_sequence(const Sequence& sequence, const DescribeOptions& options) {
  const FeatureExtractor extractor(options.features);
  std::vector<std::optional<DescribedFrame>> frames(sequence.frames.size());
  std::vector<std::string> problems(sequence.frames.size());
  std::mutex progress_mutex;
  std::size_t num_done = 0;
  parallel_for(frames.size(), options.num_threads, [&](std::size_t i) {
    try {
      frames[i] = describe(sequence, i, extractor);
    } catch (const InputError& error) {
      if (options.if_damaged == IfDamaged::Refuse) throw;
      problems[i] = error.what();
    }
    const std::lock_guard lock(progress_mutex);
    ++num_done;
    if (options.progress) options.progress("features", num_done, frames.size());
  });
  DescribedSequence described;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i]) {
      described.frames.push_back(std::move(*frames[i]));
    } else {
      described.damaged_frames.push_back(i);
      if (options.warn) options.warn(problems[i] + " (skipped)");
    }
  }
  if (described.frames.empty()) {
    throw InputError(sequence.name + ": none of its " + std::to_string(frames.size()) +
                     " images could be read; the first: " + (problems.empty() ? "there is none" : problems.front()));
  }
  return described;
}

}  // namespace fabloop
