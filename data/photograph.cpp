// SPDX-License-Identifier: BSD-3-Clause
#include "data/photograph.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "data/noise.h"
#include "data/random.h"

namespace fabloop {
namespace {

/// Frames over which the exposure changes.
constexpr double kExposureFrames = 25;

/// Averages along the way of the picture, at half-pixel steps.
cv::Mat1f motion_kernel(const Eigen::Vector2d& motion_px) {
  const int half = static_cast<int>(std::ceil(0.5 * motion_px.cwiseAbs().maxCoeff())) + 1;
  cv::Mat1f kernel(2 * half + 1, 2 * half + 1, 0.0F);
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * motion_px.norm())));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = motion_px * (static_cast<double>(i) / steps - 0.5) + Eigen::Vector2d(half, half);
    const int col = static_cast<int>(at.x());
    const int row = static_cast<int>(at.y());
    const auto fx = static_cast<float>(at.x() - col);
    const auto fy = static_cast<float>(at.y() - row);
    kernel(row, col) += (1 - fx) * (1 - fy);
    kernel(row, col + 1) += fx * (1 - fy);
    kernel(row + 1, col) += (1 - fx) * fy;
    kernel(row + 1, col + 1) += fx * fy;
  }
  kernel *= 1.0 / cv::sum(kernel)[0];
  return kernel;
}

/// Nearly normal with standard deviation 1: the sum of four uniform bytes.
float noise_of_bytes(std::uint32_t bytes) {
  constexpr float kMean = 4 * 127.5F;
  constexpr float kDeviation = 147.8F;  // sqrt(4 (256^2 - 1) / 12)
  const auto sum = static_cast<float>((bytes & 255U) + ((bytes >> 8) & 255U) + ((bytes >> 16) & 255U) + (bytes >> 24));
  return (sum - kMean) / kDeviation;
}

/// Light and noise on one row. Noise is mostly the same in the three channels, as after a camera's own demosaicing.
void expose_row(cv::Vec3b* pixels, int row, const cv::Size& size, const CameraEffects& effects) {
  Random random(effects.noise_seed, static_cast<std::uint64_t>(row));
  const auto noise = static_cast<float>(effects.noise);
  const double half_diagonal2 = 0.25 * (size.width * size.width + size.height * size.height);
  const double y = row - 0.5 * size.height;
  for (int col = 0; col < size.width; ++col) {
    const double x = col - 0.5 * size.width;
    const auto light = static_cast<float>(effects.gain * (1.0 - effects.vignetting * (x * x + y * y) / half_diagonal2));
    const std::uint64_t first = random.bits();
    const std::uint64_t second = random.bits();
    const float common = 0.8F * noise_of_bytes(static_cast<std::uint32_t>(first));
    const float own[3] = {noise_of_bytes(static_cast<std::uint32_t>(first >> 32)),
                          noise_of_bytes(static_cast<std::uint32_t>(second)),
                          noise_of_bytes(static_cast<std::uint32_t>(second >> 32))};
    for (int channel = 0; channel < 3; ++channel) {
      const float value = light * static_cast<float>(pixels[col][channel]);
      // Shot noise grows with the square root of the light; a quarter of it is the sensor's own.
      const float deviation = noise * (0.5F + 0.5F * std::sqrt(value / 128.0F));
      pixels[col][channel] = cv::saturate_cast<uchar>(value + deviation * (common + 0.6F * own[channel]));
    }
  }
}

}  // namespace

CameraEffects draw_camera_effects(std::size_t frame, const CameraEffectsOptions& options) {
  Random random(options.seed, 0xCA3E7A00000000ULL + frame);
  CameraEffects effects;
  const auto slow_seed = static_cast<std::uint32_t>(scramble(options.seed));
  const double slow = line_noise(static_cast<double>(frame) / kExposureFrames, slow_seed);
  effects.gain = std::exp(options.exposure_spread * (slow + 0.15 * random.normal()));
  const bool is_soft = random.uniform() < options.p_soft;
  const double blur = is_soft ? 3.0 : 1.0;
  // Mostly along the flight, which is up and down in the picture.
  const double heading = kPi / 2 + 0.5 * random.normal();
  const double length_px = blur * random.uniform(0, options.max_motion_px);
  effects.motion_px = length_px * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  effects.defocus_px = blur * random.uniform(0.3, 0.6);
  effects.noise = options.noise;
  effects.noise_seed = random.bits();
  return effects;
}

cv::Mat3b photograph(const cv::Mat3b& clean, const CameraEffects& effects) {
  cv::Mat3b image;
  if (effects.motion_px.norm() > 0.1) {
    cv::filter2D(clean, image, -1, motion_kernel(effects.motion_px), {-1, -1}, 0, cv::BORDER_REFLECT_101);
  } else {
    image = clean.clone();
  }
  if (effects.defocus_px > 0.1) cv::GaussianBlur(image, image, {}, effects.defocus_px);
  if (effects.sharpening > 0) {
    cv::Mat3b smooth;
    cv::GaussianBlur(image, smooth, {}, 1.0);
    cv::addWeighted(image, 1 + effects.sharpening, smooth, -effects.sharpening, 0, image);
  }
  for (int row = 0; row < image.rows; ++row) expose_row(image[row], row, image.size(), effects);
  return image;
}

}  // namespace fabloop
