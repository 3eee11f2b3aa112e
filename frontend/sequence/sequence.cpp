// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/sequence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "frontend/error.h"
#include "frontend/sequence/association.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/exif.h"
#include "frontend/sequence/frames_csv.h"
#include "frontend/sequence/image_folder.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

void warn(const SequenceOptions& options, const std::string& message) {
  if (options.warn) options.warn(message);
}

/// "0.01" rather than "0.010000".
std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string name_of(const fs::path& folder) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal.filename().string() : normal.parent_path().filename().string();
}

void require_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error))
    throw InputError(folder.string() + ": there is no such folder; give the folder that holds the images");
  if (!fs::is_directory(folder, error)) throw InputError(folder.string() + ": is a file; give the folder that holds the images");
}

/// Frames of the images that the csv names, looked for beside the others and in the sequence's folder.
std::vector<Frame> frames_from_csv(const fs::path& csv, const std::vector<fs::path>& images, const SequenceOptions& options) {
  std::vector<Frame> frames;
  const fs::path image_folder = images.front().parent_path();
  for (const StampedImage& image : read_frames_csv(csv)) {
    fs::path path = image_folder / image.filename;
    if (!fs::exists(path)) path = csv.parent_path() / image.filename;
    if (!fs::exists(path)) {
      throw InputError(csv.string() + ":" + std::to_string(image.line) + ": there is no image '" + image.filename + "' in " +
                       image_folder.string() + "; copy it there or remove the line");
    }
    frames.push_back({path, image.time_ns, {}, {}});
  }
  if (frames.size() < images.size()) {
    warn(options, csv.string() + ": lists " + std::to_string(frames.size()) + " of " + std::to_string(images.size()) +
                      " images; the others are left out");
  }
  return frames;
}

/// Frames stamped by their file names where all of these are times, else 1 s apart.
std::vector<Frame> frames_from_names(const std::vector<fs::path>& images) {
  std::vector<Frame> frames;
  for (const fs::path& image : images) {
    if (const auto time_ns = time_from_filename(image)) frames.push_back({image, *time_ns, {}, {}});
  }
  std::stable_sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) { return a.time_ns < b.time_ns; });
  const bool has_a_time_twice = std::adjacent_find(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) {
                                  return a.time_ns == b.time_ns;
                                }) != frames.end();
  if (frames.size() == images.size() && !has_a_time_twice) return frames;
  frames.clear();
  for (const fs::path& image : images) {
    frames.push_back({image, static_cast<std::int64_t>(frames.size()) * kNanosecondsPerSecond, {}, {}});
  }
  return frames;
}

std::vector<Frame> list_frames(const fs::path& folder, const SequenceOptions& options) {
  std::vector<fs::path> images = list_images(folder / "images");
  if (images.empty()) images = list_images(folder);
  if (images.empty()) {
    throw InputError(folder.string() + ": holds no images (jpg, png, tif, bmp, pgm, ppm, webp), nor does its folder images/");
  }
  for (const char* name : {"frames.csv", "track.csv"}) {
    if (fs::exists(folder / name)) return frames_from_csv(folder / name, images, options);
  }
  return frames_from_names(images);
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
  require_folder(folder);
  Sequence sequence;
  sequence.name = name_of(folder);
  sequence.frames = list_frames(folder, options);
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
