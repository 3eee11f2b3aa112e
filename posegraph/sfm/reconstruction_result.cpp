// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruction_result.h"

#include <algorithm>
#include <string>

#include "posegraph/sfm/resection.h"

namespace fabloop {
namespace {

cv::Vec3b colour_of(const ColourViews& views, const Track& track, const SegmentPoint& point) {
  cv::Vec3d sum(0, 0, 0);
  for (const std::uint32_t i : point.seen_by) sum += cv::Vec3d(views.red_green_blue[track[i].view][track[i].feature]);
  return cv::Vec3b(sum * (1.0 / static_cast<double>(point.seen_by.size())));
}

std::string why_left_out(const Scene& scene, const std::vector<ViewPair>& pairs, const std::vector<Segment>& segments,
                         std::size_t view, const GrowthOptions& options) {
  for (std::size_t s = 1; s < segments.size(); ++s) {
    if (segments[s].world_from_cameras[view]) return "belongs to a part that shares too little with the largest";
  }
  const auto num_features = scene.views[view].features.keypoints.size();
  if (num_features < 2 * options.resection.min_inliers) {
    return "shows only " + std::to_string(num_features) + " features: blurred, or of water or sky";
  }
  const auto num_pairs =
      std::count_if(pairs.begin(), pairs.end(), [&](const ViewPair& pair) { return pair.query == view || pair.match == view; });
  if (num_pairs == 0) return "no other image provably overlaps it";
  const std::size_t num_seen = visibility(scene, segments.front(), view).num_points;
  if (num_seen < options.resection.min_inliers) {
    const std::string points =
        num_seen == 0 ? "none of the map's points" : "only " + std::to_string(num_seen) + " of the map's points";
    return "sees " + points + ", where " + std::to_string(options.resection.min_inliers) + " are needed";
  }
  return "too few of the " + std::to_string(num_seen) + " points that it should see agree on one place";
}

}  // namespace

Trajectory trajectory_of(const Reconstruction& reconstruction) {
  Trajectory trajectory;
  for (const PlacedImage& image : reconstruction.images) trajectory.push_back({image.time_ns, image.world_from_camera});
  return trajectory;
}

Pose pose_at_sighting(const Reconstruction& reconstruction, const Sighting& sighting) {
  const PlacedImage& image = reconstruction.images[sighting.image];
  const double share = readout_share(reconstruction.cameras[image.camera], sighting.pixel.y());
  return pose_at_row(image.world_from_camera, image.readout, share);
}

Reconstruction to_reconstruction(const Sequence& sequence, const ColourViews& views, const Scene& scene, const Segment& segment) {
  Reconstruction result;
  result.cameras = {scene.views.front().camera};
  std::vector<std::size_t> image_of(scene.views.size(), 0);
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    if (!segment.world_from_cameras[view]) continue;
    const Frame& frame = sequence.frames[scene.views[view].frame];
    image_of[view] = result.images.size();
    result.images.push_back({scene.views[view].frame, frame.image_path, frame.time_ns, 0, *segment.world_from_cameras[view]});
    if (!segment.readout_motions.empty()) result.images.back().readout = segment.readout_motions[view];
  }
  for (std::size_t t = 0; t < segment.points.size(); ++t) {
    if (!segment.points[t]) continue;
    const Track& track = scene.tracks.tracks[t];
    ScenePoint point{segment.points[t]->x_in_world, colour_of(views, track, *segment.points[t]), {}};
    for (const std::uint32_t i : segment.points[t]->seen_by)
      point.track.push_back({image_of[track[i].view], pixel_of(scene, track[i])});
    result.points.push_back(std::move(point));
  }
  return result;
}

void tell_what_is_left(const ColourViews& views, const Scene& scene, const std::vector<ViewPair>& pairs,
                       const std::vector<Segment>& segments, const GrowthOptions& options, Reconstructed& result) {
  for (const UnreadFrame& frame : views.unread) result.left_out.push_back({frame.frame, frame.why});
  for (std::size_t view = 0; view < views.views.size(); ++view) {
    if (segments.front().world_from_cameras[view]) continue;
    result.left_out.push_back({views.views[view].frame, why_left_out(scene, pairs, segments, view, options)});
  }
  std::sort(result.left_out.begin(), result.left_out.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  for (std::size_t s = 1; s < segments.size(); ++s) {
    result.other_parts.emplace_back();
    for (std::size_t view = 0; view < views.views.size(); ++view) {
      if (segments[s].world_from_cameras[view]) result.other_parts.back().push_back(views.views[view].frame);
    }
  }
  for (const ViewPair& pair : pairs) {
    result.pairs.push_back({views.views[pair.query].frame, views.views[pair.match].frame, pair.num_matches, pair.inliers.size(),
                            pair.median_parallax_deg});
  }
}

}  // namespace fabloop
