// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>

namespace fabloop {

/// What a real camera adds to one picture.
struct CameraEffects {
  double gain = 1;                     ///< Exposure: factor on the brightness.
  Eigen::Vector2d motion_px = {0, 0};  ///< Way of the picture over the sensor during the exposure.
  double defocus_px = 0.5;             ///< Standard deviation of the blur of the lens.
  double sharpening = 0.6;             ///< Share of the detail that the camera adds again (an unsharp mask of 1 px). 0: none.
  double noise = 2.5;                  ///< Standard deviation of a pixel at mid grey, of 255.
  double vignetting = 0.12;            ///< Loss of light in the corners, in [0, 1].
  std::uint64_t noise_seed = 0;
};

/// How much the effects vary over a flight.
struct CameraEffectsOptions {
  std::uint64_t seed = 1;
  double exposure_spread = 0.18;  ///< Slow changes of the exposure (clouds, automatic exposure), as a logarithm. 0: none.
  double max_motion_px = 1.6;     ///< Longest motion blur of usual frames.
  double p_soft = 0.03;           ///< Share of frames that are blurred three times as much: a gust, a focus hunt.
  double noise = 2.5;             ///< See CameraEffects.
};

/// The effects of the frame number `frame`; the same numbers for the same seed and frame.
CameraEffects draw_camera_effects(std::size_t frame, const CameraEffectsOptions& options = {});

/// The picture that such a camera takes of a clean image. Same size.
cv::Mat3b photograph(const cv::Mat3b& clean, const CameraEffects& effects);

}  // namespace fabloop
