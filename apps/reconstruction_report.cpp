// SPDX-License-Identifier: BSD-3-Clause
#include "apps/reconstruction_report.h"

#include <iomanip>
#include <map>
#include <vector>

namespace fabloop::apps {
namespace {

/// "3, 7-12, 20".
std::string frame_ranges(const std::vector<std::size_t>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i;
    while (end + 1 < frames.size() && frames[end + 1] == frames[end] + 1) ++end;
    if (!text.empty()) text += ", ";
    text += std::to_string(frames[i]);
    if (end > i) text.append("-").append(std::to_string(frames[end]));
    i = end + 1;
  }
  return text;
}

}  // namespace

void print_reconstruction_report(std::ostream& out, const Sequence& sequence, const Reconstructed& result,
                                 const std::string& folder) {
  const Reconstruction& map = result.reconstruction;
  out << std::setprecision(3) << folder << ": " << map.images.size() << " of " << sequence.frames.size() << " images placed, "
      << map.points.size() << " points, mean reprojection error " << result.mean_error_px << " px over " << result.num_sightings
      << " sightings\n";
  if (result.feature_pixel_size > 1) {
    out << "  features were found in images shrunk by " << result.feature_pixel_size << ": errors are "
        << result.mean_error_px / result.feature_pixel_size << " px there\n";
  }
  out << "  " << result.pairs.size() << " of " << result.num_candidate_pairs << " candidate pairs overlap\n";
  std::map<std::string, std::vector<std::size_t>> by_reason;
  for (const LeftOutFrame& frame : result.left_out) by_reason[frame.why].push_back(frame.frame);
  for (const auto& [why, frames] : by_reason) out << "  left out " << frame_ranges(frames) << ": " << why << '\n';
  for (const auto& part : result.other_parts) out << "  a part of its own: " << frame_ranges(part) << '\n';
  if (result.camera_check.is_contradicted && !result.camera_was_refined) {
    out << "  the images contradict the camera's focal length: they agree best with " << result.camera_check.best_focal_factor
        << " of it, and the map is bent accordingly\n";
  }
  if (const RollingShutterCheck& shutter = result.rolling_shutter_check; shutter.is_known) {
    out << "  shutter: the images tell " << shutter.shift_px() << " px from the first row to the last, sigma "
        << shutter.shift_sigma_px() << " px";
    if (result.modelled_readout) {
      out << "; the map has a rolling shutter of " << result.modelled_readout->readout_s
          << (sequence.has_times ? " s" : " of the step from image to image");
    }
    out << '\n';
  }
  if (const auto& found = result.georeference.found) {
    out << "  known positions: " << found->num_inliers << " of " << found->num_positions << " agree with the map, rms "
        << found->rms_m << " m\n";
  }
  if (map.unit == LengthUnit::Arbitrary) out << "  the unit of length is arbitrary: images alone show none\n";
  for (const StageTime& time : result.times) out << "  " << time.stage << ' ' << time.seconds << " s\n";
}

}  // namespace fabloop::apps
