// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_truth.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/sequence/association.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKinds =
    "; give a folder with pairs.csv or reference.tum, a pairs.csv, a loop matrix (.npy, or text of 0 and 1), or poses in TUM "
    "form";

std::size_t num_frames(const std::vector<ObservedImage>& images) { return images.empty() ? 0 : images.back().frame + 1; }

/// One entry a frame up to the last image; none where there is no image, or no pose at its time.
std::vector<std::optional<Pose>> read_frame_poses(const fs::path& path, const std::vector<ObservedImage>& images,
                                                  const RecognitionTruthOptions& options) {
  const Trajectory trajectory = read_tum(path);
  std::vector<std::int64_t> times_ns;
  for (const ObservedImage& image : images) times_ns.push_back(image.time_ns);
  const auto max_difference_ns = static_cast<std::int64_t>(std::llround(options.max_time_difference_s * 1e9));
  const auto poses = poses_at(trajectory, times_ns, max_difference_ns);
  std::vector<std::optional<Pose>> result(num_frames(images));
  bool has_any = false;
  for (std::size_t i = 0; i < images.size(); ++i) {
    result[images[i].frame] = poses[i];
    has_any = has_any || poses[i].has_value();
  }
  if (!has_any) throw InputError(path.string() + ": no pose is near an image in time; is it the truth of another sequence?");
  return result;
}

GroundTruth read_pair_truth(const fs::path& path, const std::vector<ObservedImage>& images,
                            const RecognitionTruthOptions& options) {
  std::vector<bool> has_reference(num_frames(images), true);
  const fs::path reference = path.parent_path() / "reference.tum";
  if (fs::exists(reference)) {
    const auto poses = read_frame_poses(reference, images, options);
    for (std::size_t frame = 0; frame < poses.size(); ++frame) has_reference[frame] = poses[frame].has_value();
  }
  return truth_from_pairs(read_pairs(path), std::move(has_reference), options.exclusion_window, options.pairs);
}

void require_exists(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path.string() + ": there is no such file or folder" + kKinds);
}

/// The poses that a folder or file holds.
fs::path pose_file(const fs::path& path) {
  if (!fs::is_directory(path)) return path;
  if (!fs::exists(path / "reference.tum")) throw InputError(path.string() + ": has no truth in it" + kKinds);
  return path / "reference.tum";
}

}  // namespace

bool is_loop_matrix(const fs::path& path) {
  if (path.extension() == ".npy") return true;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    const bool other = line.find_first_not_of("01., ;\t\r") != std::string::npos;
    // Poses and pairs have longer numbers; a matrix has none.
    return !other && line.find("00") == std::string::npos && line.find("10") == std::string::npos &&
           line.find("01") == std::string::npos && line.find("11") == std::string::npos;
  }
  return false;
}

GroundTruth read_truth(const fs::path& path, const std::vector<ObservedImage>& images, const RecognitionTruthOptions& options) {
  require_exists(path);
  if (fs::is_directory(path) && fs::exists(path / "pairs.csv")) return read_pair_truth(path / "pairs.csv", images, options);
  if (path.filename() == "pairs.csv") return read_pair_truth(path, images, options);
  if (!fs::is_directory(path) && is_loop_matrix(path)) {
    return truth_from_matrix(read_loop_matrix(path), options.exclusion_window);
  }
  auto poses = read_frame_poses(pose_file(path), images, options);
  return truth_from_poses(poses, poses, options.exclusion_window, options.poses);
}

GroundTruth read_truth_in_map(const fs::path& path, const std::vector<ObservedImage>& queries, const fs::path& map_path,
                              const std::vector<ObservedImage>& map, const RecognitionTruthOptions& options) {
  require_exists(path);
  if (!fs::is_directory(path) && is_loop_matrix(path)) return truth_from_matrix(read_loop_matrix(path), std::nullopt);
  if (map_path.empty()) {
    throw InputError(path.string() +
                     ": holds the queries' poses; give the map's, in the same world frame, with --map-truth, or a loop matrix");
  }
  require_exists(map_path);
  return truth_from_poses(read_frame_poses(pose_file(path), queries, options),
                          read_frame_poses(pose_file(map_path), map, options), std::nullopt, options.poses);
}

}  // namespace fabloop
