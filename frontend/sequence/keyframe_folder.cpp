// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/keyframe_folder.h"

#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "frontend/error.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/image_source.h"
#include "frontend/sequence/stamped_images.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::none, error);
  if (error == std::errc::file_exists) {
    throw InputError(from.string() + ": another image has that name, in another folder; give each its own");
  }
  if (error) throw InputError(from.string() + ": cannot be copied to " + to.string() + ": " + error.message());
}

void write_jpeg(const cv::Mat& image, const fs::path& path) {
  constexpr int kQuality = 95;
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  OutputFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

fs::path full_path(const fs::path& path) {
  const fs::path found = fs::weakly_canonical(path);
  return found.has_filename() ? found : found.parent_path();
}

/// Throws where the output would be written over what it is made of.
void require_apart(const fs::path& input, const fs::path& out) {
  if (input.empty()) return;
  const fs::path of_input = full_path(input), of_out = full_path(out);
  const auto end = std::mismatch(of_out.begin(), of_out.end(), of_input.begin(), of_input.end()).first;
  if (end == of_out.end()) {
    throw InputError(out.string() + ": holds " + input.string() +
                     ", which would be replaced by what is made of it; give another folder");
  }
}

/// Throws for names that a line of `frames.csv` cannot hold.
void require_writable(const std::string& name) {
  const bool has_space_about = name.front() == ' ' || name.back() == ' ';
  if (name.find_first_of(",\"\n\r") != std::string::npos || name.front() == '#' || has_space_about) {
    throw InputError("'" + name +
                     "': frames.csv cannot hold such a name; rename the image, without commas, quotes, # and spaces about it");
  }
}

std::string video_frame_name(std::size_t frame) {
  char name[40];
  std::snprintf(name, sizeof name, "frame_%06zu.jpg", frame);
  return name;
}

/// What else a sequence folder knows of its images by time or by name.
void copy_companions(const fs::path& source, const fs::path& out, const fs::path& camera) {
  for (const char* name : {"camera.yaml", "odometry.tum", "reference.tum", "gps.csv"}) {
    const bool is_given = !camera.empty() && name == std::string("camera.yaml");
    if (!is_given && fs::is_regular_file(source / name)) copy_to(source / name, out / name);
  }
  if (!camera.empty()) copy_to(camera, out / "camera.yaml");
}

}  // namespace

KeyframeCount write_keyframe_folder(const fs::path& source, const fs::path& out_path, const KeyframeFolderOptions& options) {
  if (!options.camera.empty()) read_camera_yaml(options.camera);
  for (const fs::path& input : {source, options.camera}) require_apart(input, out_path);
  const bool is_folder = fs::is_directory(source);
  std::vector<StampedPath> files;
  if (is_folder) files = list_stamped_images(source);
  ImageSource images(
      source, {.keep_colour = true, .if_damaged = options.if_damaged, .num_threads = options.num_threads, .warn = options.warn});
  OutputFolder out(out_path, options.if_exists);
  fs::create_directories(out.part_path() / "images");
  OutputFile frames(out.part_path() / "frames.csv");
  frames.stream() << "# filename,timestamp_s\n";

  KeyframeChoice choice(options.choice);
  KeyframeCount count;
  constexpr std::size_t kAtATime = 8;
  for (auto block = images.next(kAtATime); !block.empty(); block = images.next(kAtATime)) {
    for (const SourceImage& image : block) {
      ++count.num_images;
      if (!choice.takes(image.gray)) continue;
      ++count.num_keyframes;
      const fs::path name = is_folder ? files[image.frame].path.filename() : fs::path(video_frame_name(image.frame));
      require_writable(name.string());
      if (is_folder) {
        copy_to(files[image.frame].path, out.part_path() / "images" / name);
      } else {
        write_jpeg(image.colour, out.part_path() / "images" / name);
      }
      frames.stream() << name.string() << ',' << seconds_from_nanoseconds(image.time_ns) << '\n';
    }
    if (options.progress)
      options.progress("keyframes", block.back().frame + 1, images.estimated_size().value_or(block.back().frame + 1));
  }
  if (count.num_images == 0) throw InputError(source.string() + ": none of its images can be read; copy it again");
  frames.commit();
  copy_companions(source, out.part_path(), options.camera);
  out.commit();
  return count;
}

}  // namespace fabloop
