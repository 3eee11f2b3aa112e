// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/progress.h"

namespace fabloop {

/// One image of a sequence and what is known of it before it is looked at.
struct Frame {
  std::filesystem::path image_path;
  std::int64_t time_ns = 0;
  std::optional<Pose> odom_from_camera;   ///< The host's odometry, where it has a pose at this time.
  std::optional<Pose> world_from_camera;  ///< The reference, where known. Only evaluation may look at it.
};

/// A camera and its images, in order of time.
struct Sequence {
  std::string name;
  Camera camera;
  std::vector<Frame> frames;
  bool has_times = true;  ///< Its stamps are times. Else there were none, and images count as one second apart.
};

/// Where the parts of a sequence are when they are not at their usual places in its folder.
struct SequenceOptions {
  std::filesystem::path camera{};     ///< Calibration file. Empty: `camera.yaml` in the folder, else the EXIF focal length.
  std::filesystem::path odometry{};   ///< TUM file. Empty: no odometry is read.
  std::filesystem::path reference{};  ///< TUM file. Empty: `reference.tum` in the folder where there is one.
  /// Largest difference between an image's time and its pose's. The field's usual 0.01 s; more for loosely stamped logs.
  double max_time_difference_s = 0.01;
  Warn warn{};  ///< Told about anything that a user should know (an EXIF guess, frames without odometry, ...).
};

/// Reads what describes a sequence; images are read later, one by one. Images and stamps are found as by list_stamped_images.
/// Throws InputError: folder missing or empty, no calibration, a bad line, odometry that overlaps no image in time.
Sequence read_sequence(const std::filesystem::path& folder, const SequenceOptions& options = {});

/// The image as 8-bit grey (`CV_8UC1`), of whatever size. Throws InputError naming the file when it is missing, truncated or
/// damaged.
cv::Mat read_gray_image(const std::filesystem::path& image_path);

/// The image as 8-bit grey (`CV_8UC1`). Throws InputError naming the file when it is missing, truncated, damaged or of
/// another size than the camera's.
cv::Mat read_gray_image(const std::filesystem::path& image_path, const Camera& camera);

/// The image in colour: 8-bit blue, green, red (`CV_8UC3`); a grey file gives three equal channels.
/// Throws as read_gray_image() does.
cv::Mat read_colour_image(const std::filesystem::path& image_path, const Camera& camera);

}  // namespace fabloop
