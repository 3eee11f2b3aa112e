// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fabloop::testing_support {

/// Blobs of all sizes: strong contrast on the left third, an eighth of it on the right.
inline cv::Mat blobs() {
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(128));
  cv::RNG random(11);
  for (int i = 0; i < 1500; ++i) {
    const cv::Point centre(random.uniform(0, 320), random.uniform(0, 240));
    const int contrast = centre.x < 107 ? 100 : 12;
    cv::circle(image, centre, random.uniform(1, 5), cv::Scalar(128 + random.uniform(-contrast, contrast)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

/// Texture as ground has it: noise of all scales, amplitudes falling with frequency, around mid-grey.
inline cv::Mat ground(int width, int height, double contrast, std::uint64_t seed) {
  cv::Mat1f sum(height, width, 0.0F);
  cv::RNG random(seed);
  for (int cell = 2; cell <= 64; cell *= 2) {
    cv::Mat1f noise(height / cell + 3, width / cell + 3);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    cv::Mat layer;
    cv::resize(noise, layer, {noise.cols * cell, noise.rows * cell}, 0, 0, cv::INTER_CUBIC);
    sum += layer(cv::Rect(cell, cell, width, height)) * std::sqrt(static_cast<double>(cell));
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(sum, mean, deviation);
  cv::Mat image;
  sum.convertTo(image, CV_8U, contrast / deviation[0], 128.0 - mean[0] * contrast / deviation[0]);
  return image;
}

}  // namespace fabloop::testing_support
