// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/sequence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <utility>

#include "frontend/error.h"
#include "frontend/sequence/association.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/exif.h"
#include "frontend/sequence/stamped_images.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void warn(const SequenceOptions& options, const std::string& message) {
  if (options.warn) options.warn(message);
}

/// "0.01" rather than "0.010000".
std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Camera find_camera(const fs::path& folder, const fs::path& first_image, const SequenceOptions& options) {
  if (!options.camera.empty()) return read_camera_yaml(options.camera);
  if (fs::exists(folder / "camera.yaml")) return read_camera_yaml(folder / "camera.yaml");
  const cv::Mat image = cv::imread(first_image.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  const auto camera = image.empty() ? std::nullopt : camera_from_exif(first_image, image.cols, image.rows);
  if (!camera) {
    throw InputError(folder.string() + ": has no calibration: no camera.yaml, and no focal length in the EXIF of " +
                     first_image.filename().string() + "; calibrate the camera and put its ROS camera_info there as camera.yaml");
  }
  warn(options, folder.string() + ": no camera.yaml; the focal length is a guess from the EXIF of " +
                    first_image.filename().string() + " (" + std::to_string(std::lround(camera->fx)) +
                    " px), without distortion: calibrate for better poses");
  return *camera;
}

std::string span_text(std::int64_t first_ns, std::int64_t last_ns) {
  return seconds_from_nanoseconds(first_ns) + " to " + seconds_from_nanoseconds(last_ns) + " s";
}

/// One pose a frame, where the file has one at its time.
std::vector<std::optional<Pose>> read_poses(const fs::path& file, const std::vector<Frame>& frames,
                                            const SequenceOptions& options) {
  const Trajectory trajectory = read_tum(file);
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(frames.size());
  for (const Frame& frame : frames) times_ns.push_back(frame.time_ns);
  const auto max_difference_ns = static_cast<std::int64_t>(std::llround(options.max_time_difference_s * 1e9));
  auto poses = poses_at(trajectory, times_ns, max_difference_ns);
  if (std::none_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); })) {
    throw InputError(file.string() + ": no pose is within " + number_text(options.max_time_difference_s) +
                     " s of an image; poses span " + span_text(trajectory.front().time_ns, trajectory.back().time_ns) +
                     ", images span " + span_text(times_ns.front(), times_ns.back()) +
                     "; do both use the same clock, and does frames.csv give the images' times?");
  }
  return poses;
}

void read_odometry(const fs::path& file, const SequenceOptions& options, std::vector<Frame>& frames) {
  const auto poses = read_poses(file, frames, options);
  std::size_t num_missing = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].odom_from_camera = poses[i];
    if (!poses[i]) ++num_missing;
  }
  if (num_missing > 0) {
    warn(options, file.string() + ": " + std::to_string(num_missing) + " of " + std::to_string(frames.size()) +
                      " frames have no odometry within " + number_text(options.max_time_difference_s) + " s");
  }
}

}  // namespace

Sequence read_sequence(const fs::path& folder, const SequenceOptions& options) {
  if (!(options.max_time_difference_s >= 0 && options.max_time_difference_s < 1e9)) {
    throw InputError("max_time_difference_s is " + number_text(options.max_time_difference_s) + "; give 0 or more seconds");
  }
  Sequence sequence;
  for (StampedPath& image : list_stamped_images(folder, options.warn)) {
    sequence.has_times = sequence.has_times && image.is_time_known;
    sequence.frames.push_back({std::move(image.path), image.time_ns, {}, {}});
  }
  sequence.name = sequence_name(folder);
  sequence.camera = find_camera(folder, sequence.frames.front().image_path, options);
  if (!options.odometry.empty()) read_odometry(options.odometry, options, sequence.frames);
  const bool has_reference = fs::exists(folder / "reference.tum");
  const fs::path reference = !options.reference.empty() ? options.reference
                             : has_reference            ? folder / "reference.tum"
                                                        : fs::path();
  if (!reference.empty()) {
    const auto poses = read_poses(reference, sequence.frames, options);
    for (std::size_t i = 0; i < poses.size(); ++i) sequence.frames[i].world_from_camera = poses[i];
  }
  return sequence;
}

}  // namespace fabloop
