// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/stamped_images.h"

#include <algorithm>
#include <optional>

#include "frontend/error.h"
#include "frontend/sequence/frames_csv.h"
#include "frontend/sequence/image_folder.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void require_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error))
    throw InputError(folder.string() + ": there is no such folder; give the folder that holds the images");
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder.string() +
                     ": is a file; give the folder that holds the images (`fabloop keyframes` makes one of a video)");
  }
}

/// The images that the csv names, looked for beside the others and in the sequence's folder.
std::vector<StampedPath> frames_from_csv(const fs::path& csv, const std::vector<fs::path>& images, const Warn& warn) {
  std::vector<StampedPath> frames;
  const fs::path image_folder = images.front().parent_path();
  for (const StampedImage& image : read_frames_csv(csv)) {
    fs::path path = image_folder / image.filename;
    if (!fs::exists(path)) path = csv.parent_path() / image.filename;
    if (!fs::exists(path)) {
      throw InputError(csv.string() + ":" + std::to_string(image.line) + ": there is no image '" + image.filename + "' in " +
                       image_folder.string() + "; copy it there or remove the line");
    }
    frames.push_back({path, image.time_ns});
  }
  if (frames.size() < images.size() && warn) {
    warn(csv.string() + ": lists " + std::to_string(frames.size()) + " of " + std::to_string(images.size()) +
         " images; the others are left out");
  }
  return frames;
}

/// Whether a stamp from a file name may number an image: a whole number of seconds that no clock of our days shows.
bool is_a_count(const StampedPath& frame) {
  constexpr std::int64_t kLeastTime_s = 1'000'000;
  return frame.time_ns % kNanosecondsPerSecond == 0 && frame.time_ns < kLeastTime_s * kNanosecondsPerSecond;
}

/// Frames stamped by their file names where all of these are times, else 1 s apart.
std::vector<StampedPath> frames_from_names(const std::vector<fs::path>& images) {
  std::vector<StampedPath> frames;
  for (const fs::path& image : images) {
    if (const auto time_ns = time_from_filename(image)) frames.push_back({image, *time_ns});
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const StampedPath& a, const StampedPath& b) { return a.time_ns < b.time_ns; });
  const bool has_a_time_twice = std::adjacent_find(frames.begin(), frames.end(), [](const StampedPath& a, const StampedPath& b) {
                                  return a.time_ns == b.time_ns;
                                }) != frames.end();
  if (frames.size() == images.size() && !has_a_time_twice) {
    const bool counts = std::all_of(frames.begin(), frames.end(), is_a_count);
    for (StampedPath& frame : frames) frame.is_time_known = !counts;
    return frames;
  }
  frames.clear();
  for (const fs::path& image : images) {
    frames.push_back({image, static_cast<std::int64_t>(frames.size()) * kNanosecondsPerSecond, false});
  }
  return frames;
}

}  // namespace

std::vector<StampedPath> list_stamped_images(const fs::path& folder, const Warn& warn) {
  require_folder(folder);
  std::vector<fs::path> images = list_images(folder / "images");
  if (images.empty()) images = list_images(folder);
  if (images.empty()) {
    throw InputError(folder.string() + ": holds no images (jpg, png, tif, bmp, pgm, ppm, webp), nor does its folder images/");
  }
  for (const char* name : {"frames.csv", "track.csv"}) {
    if (fs::exists(folder / name)) return frames_from_csv(folder / name, images, warn);
  }
  return frames_from_names(images);
}

std::string sequence_name(const fs::path& folder) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal.filename().string() : normal.parent_path().filename().string();
}

}  // namespace fabloop
