// SPDX-License-Identifier: BSD-3-Clause
#include "data/sequence_trouble.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iomanip>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "data/random.h"
#include "data/sequence_files.h"
#include "frontend/error.h"
#include "frontend/fabmap/pair_truth.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Independent choices of one seed.
enum Stream : std::uint64_t { kDrop = 0xD809, kBlur, kExpose, kOcclude, kNoise, kSlip, kRectangles, kSigns };

struct Share {
  const char* name;
  double value;
};

void check(const SequenceTrouble& trouble) {
  for (const Share& share :
       {Share{"dropped frames", trouble.dropped_frames}, Share{"blurred frames", trouble.blurred_frames},
        Share{"wrongly exposed frames", trouble.exposed_frames}, Share{"occluded frames", trouble.occluded_frames},
        Share{"the occluded area", trouble.occluded_area}, Share{"odometry slips", trouble.odometry_slips}}) {
    if (!(share.value >= 0.0 && share.value <= 1.0))
      throw InputError("trouble: the share of " + std::string(share.name) + " must be in [0, 1]");
  }
  const bool is_finite = std::isfinite(trouble.exposure_stops) && trouble.blur_px > 0.0 && std::isfinite(trouble.blur_px) &&
                         trouble.focal_error > -1.0 && std::isfinite(trouble.focal_error) &&
                         trouble.odometry_translation_noise >= 0.0 && trouble.odometry_rotation_noise_deg >= 0.0 &&
                         std::isfinite(trouble.slip_heading_deg);
  if (!is_finite) throw InputError("trouble: sizes must be finite, noise not negative, blur positive, the focal error above -1");
}

/// Which of `count` things something happens to: exactly the share, to the nearest one.
std::vector<bool> chosen(std::size_t count, double share, std::uint64_t seed, Stream stream) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed, stream);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  std::vector<bool> is_chosen(count, false);
  const auto wanted = static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
  for (std::size_t i = 0; i < wanted; ++i) is_chosen[order[i]] = true;
  return is_chosen;
}

std::size_t count_of(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

struct FrameTroubles {
  std::vector<bool> blurred, exposed, occluded;
  bool any(std::size_t i) const { return blurred[i] || exposed[i] || occluded[i]; }
};

cv::Mat spoiled(cv::Mat image, std::size_t frame, const FrameTroubles& frames, const SequenceTrouble& trouble) {
  if (frames.blurred[frame]) cv::GaussianBlur(image, image, {}, trouble.blur_px);
  if (frames.exposed[frame]) {
    const double stops = trouble.exposure_stops * Random(trouble.seed, kSigns + 16 * frame).sign();
    image.convertTo(image, -1, std::exp2(stops));
  }
  if (frames.occluded[frame]) {
    Random random(trouble.seed, kRectangles + 16 * frame);
    const double side = std::sqrt(trouble.occluded_area);
    const cv::Size size(static_cast<int>(std::lround(side * image.cols)), static_cast<int>(std::lround(side * image.rows)));
    const cv::Point corner(static_cast<int>(random.uniform() * (image.cols - size.width + 1)),
                           static_cast<int>(random.uniform() * (image.rows - size.height + 1)));
    const cv::Scalar kDark(40, 40, 40);
    image(cv::Rect(corner, size)) = kDark;
  }
  return image;
}

/// The odometry of the frames that have one, with errors in its steps; chained from its first pose.
std::vector<std::optional<Pose>> troubled_odometry(const Sequence& sequence, const SequenceTrouble& trouble,
                                                   TroubledSequence& result) {
  std::vector<std::size_t> posed;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    if (sequence.frames[i].odom_from_camera) posed.push_back(i);
  }
  result.num_steps = posed.empty() ? 0 : posed.size() - 1;
  const std::vector<bool> slips = chosen(result.num_steps, trouble.odometry_slips, trouble.seed, kSlip);
  result.num_slips = count_of(slips);
  Random random(trouble.seed, kNoise);
  const auto noise = [&] {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Eigen::Vector3d(x, y, z);
  };
  std::vector<std::optional<Pose>> odometry(sequence.frames.size());
  for (std::size_t k = 0; k < posed.size(); ++k) {
    const Pose& now = *sequence.frames[posed[k]].odom_from_camera;
    if (k == 0) {
      odometry[posed[k]] = now;
      continue;
    }
    Pose step = sequence.frames[posed[k - 1]].odom_from_camera->inverse() * now;
    const double length = step.translation.norm();
    Eigen::Vector3d turn_rad = rad_from_deg(trouble.odometry_rotation_noise_deg) * noise();
    step.translation += trouble.odometry_translation_noise * length * noise();
    const double slip_length = random.uniform(0.0, 2.0), slip_heading = random.uniform(-1.0, 1.0);
    if (slips[k - 1]) {
      const Eigen::Vector3d up_in_camera = now.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      turn_rad += slip_heading * rad_from_deg(trouble.slip_heading_deg) * up_in_camera;
      step.translation *= slip_length;
    }
    const double angle = turn_rad.norm();
    if (angle > 0.0) step.rotation = step.rotation * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_rad / angle));
    odometry[posed[k]] = *odometry[posed[k - 1]] * step;
    odometry[posed[k]]->rotation.normalize();
  }
  return odometry;
}

void write_trajectory(const fs::path& path, const Sequence& sequence, const std::vector<std::optional<Pose>>& poses) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i]) trajectory.push_back({sequence.frames[i].time_ns, *poses[i]});
  }
  if (!trajectory.empty()) write_tum(path, trajectory);
}

void write_pairs(const fs::path& path, const PairTruths& pairs, const std::vector<std::size_t>& kept, std::size_t num_before) {
  std::vector<std::optional<std::size_t>> position(num_before);
  for (std::size_t i = 0; i < kept.size(); ++i) position[kept[i]] = i;
  OutputFile file(path);
  file.stream() << "# i,j (positions in frames.csv), distance (not kept), overlap, inliers\n" << std::setprecision(17);
  for (const auto& [frames, pair] : pairs) {
    if (frames.second >= num_before)
      throw InputError(path.filename().string() + ": a pair names a frame that the sequence has not");
    const auto i = position[frames.first], j = position[frames.second];
    if (i && j) file.stream() << *i << ',' << *j << ",," << pair.overlap << ',' << pair.num_inliers << '\n';
  }
  file.commit();
}

void write_frames(const fs::path& folder, const Sequence& sequence, const FrameTroubles& troubles,
                  const SequenceTrouble& trouble) {
  fs::create_directories(folder / "images");
  OutputFile file(folder / "frames.csv");
  file.stream() << "# filename,timestamp_s\n";
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const Frame& frame = sequence.frames[i];
    fs::path name = frame.image_path.filename();
    if (troubles.any(i)) {
      name.replace_extension(".png");
      write_image(folder / "images" / name, spoiled(read_colour_image(frame.image_path, sequence.camera), i, troubles, trouble));
    } else {
      std::error_code error;
      fs::copy_file(frame.image_path, folder / "images" / name, error);
      if (error) throw InputError(frame.image_path.string() + ": could not be copied: " + error.message());
    }
    file.stream() << name.string() << ',' << seconds_from_nanoseconds(frame.time_ns) << '\n';
  }
  file.commit();
}

}  // namespace

bool is_trouble_free(const SequenceTrouble& trouble) {
  return trouble.dropped_frames == 0.0 && trouble.blurred_frames == 0.0 && trouble.exposed_frames == 0.0 &&
         trouble.occluded_frames == 0.0 && trouble.focal_error == 0.0 && trouble.odometry_translation_noise == 0.0 &&
         trouble.odometry_rotation_noise_deg == 0.0 && trouble.odometry_slips == 0.0;
}

TroubledSequence write_troubled_sequence(const fs::path& from, const fs::path& to, const SequenceTrouble& trouble,
                                         OutputFolder::IfExists if_exists) {
  check(trouble);
  const Sequence whole = read_sequence(from, {.camera = from / "camera.yaml", .odometry = from / "odometry.tum"});
  TroubledSequence result;
  const std::vector<bool> dropped = chosen(whole.frames.size(), trouble.dropped_frames, trouble.seed, kDrop);
  Sequence sequence{whole.name, whole.camera, {}};
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < whole.frames.size(); ++i) {
    if (dropped[i]) continue;
    sequence.frames.push_back(whole.frames[i]);
    kept.push_back(i);
  }
  if (kept.empty()) throw InputError("trouble: no frame is left");
  result.num_frames = kept.size();
  result.num_dropped = count_of(dropped);
  const FrameTroubles troubles{chosen(kept.size(), trouble.blurred_frames, trouble.seed, kBlur),
                               chosen(kept.size(), trouble.exposed_frames, trouble.seed, kExpose),
                               chosen(kept.size(), trouble.occluded_frames, trouble.seed, kOcclude)};
  result.num_blurred = count_of(troubles.blurred);
  result.num_exposed = count_of(troubles.exposed);
  result.num_occluded = count_of(troubles.occluded);

  OutputFolder folder(to, if_exists);
  const fs::path& part = folder.part_path();
  write_frames(part, sequence, troubles, trouble);
  write_trajectory(part / "odometry.tum", sequence, troubled_odometry(sequence, trouble, result));
  std::vector<std::optional<Pose>> reference;
  for (const Frame& frame : sequence.frames) reference.push_back(frame.world_from_camera);
  write_trajectory(part / "reference.tum", sequence, reference);
  if (fs::exists(from / "pairs.csv")) write_pairs(part / "pairs.csv", read_pairs(from / "pairs.csv"), kept, whole.frames.size());
  Camera camera = whole.camera;
  camera.fx *= 1.0 + trouble.focal_error;
  camera.fy *= 1.0 + trouble.focal_error;
  write_camera_yaml(part / "camera.yaml", camera);
  folder.commit();
  return result;
}

}  // namespace fabloop
