// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruction_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace fabloop {
namespace {

using PointsOfImage = std::vector<std::vector<std::uint32_t>>;

PointsOfImage points_of_images(const Reconstruction& map) {
  PointsOfImage points(map.images.size());
  for (std::uint32_t p = 0; p < map.points.size(); ++p) {
    for (const Sighting& sighting : map.points[p].track) points[sighting.image].push_back(p);
  }
  return points;
}

/// Derivative of the pixel (of a pinhole) by (translation, rotation) of the camera, on the tangent of world_from_camera * error.
Eigen::Matrix<double, 2, 6> pixel_by_pose(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  const double z = x_in_camera.z();
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << camera.fx / z, 0, -camera.fx * x_in_camera.x() / (z * z), 0, camera.fy / z, -camera.fy * x_in_camera.y() / (z * z);
  Eigen::Matrix<double, 3, 6> point_by_pose;
  point_by_pose << -Eigen::Matrix3d::Identity(), cross_matrix(x_in_camera);
  return by_point * point_by_pose;
}

SharedView shared_view(const Reconstruction& map, std::size_t query, std::size_t match,
                       const std::vector<std::uint32_t>& points) {
  const PlacedImage& image = map.images[query];
  const Camera& camera = map.cameras[image.camera];
  SharedView shared{query, match, points.size(), map.images[match].world_from_camera.inverse() * image.world_from_camera};
  double squared_px = 0;
  for (const std::uint32_t p : points) {
    const ScenePoint& point = map.points[p];
    const auto sighting =
        std::find_if(point.track.begin(), point.track.end(), [&](const Sighting& s) { return s.image == query; });
    const Pose world_from_row = pose_at_sighting(map, *sighting);
    const double error_px = reprojection_error_px(camera, world_from_row, point.x_in_world, sighting->pixel);
    squared_px += error_px * error_px;
    const Eigen::Matrix<double, 2, 6> by_pose = pixel_by_pose(camera, world_from_row.inverse() * point.x_in_world);
    shared.information += by_pose.transpose() * by_pose;
  }
  constexpr double kLeastVariance_px2 = 0.01;  // a detector's own
  const double variance_px2 = std::max(kLeastVariance_px2, squared_px / static_cast<double>(2 * points.size()));
  shared.rms_error_px = std::sqrt(squared_px / static_cast<double>(points.size()));
  shared.information /= variance_px2;
  return shared;
}

std::map<std::size_t, std::size_t> image_by_frame(const Reconstruction& map) {
  std::map<std::size_t, std::size_t> images;
  for (std::size_t i = 0; i < map.images.size(); ++i) images[map.images[i].frame] = i;
  return images;
}

}  // namespace

std::vector<SharedView> shared_views(const Reconstructed& result, const ReconstructionGraphOptions& options) {
  const Reconstruction& map = result.reconstruction;
  const PointsOfImage points = points_of_images(map);
  const auto images = image_by_frame(map);
  std::vector<SharedView> views;
  for (const FramePair& pair : result.pairs) {
    const auto query = images.find(pair.query);
    const auto match = images.find(pair.match);
    if (query == images.end() || match == images.end()) continue;
    std::vector<std::uint32_t> both;
    std::set_intersection(points[query->second].begin(), points[query->second].end(), points[match->second].begin(),
                          points[match->second].end(), std::back_inserter(both));
    if (both.size() >= options.min_shared_points) views.push_back(shared_view(map, query->second, match->second, both));
  }
  return views;
}

PoseGraph reconstruction_graph(const Reconstructed& result, const ReconstructionGraphOptions& options) {
  const Reconstruction& map = result.reconstruction;
  PoseGraph graph;
  for (const PlacedImage& image : map.images) {
    graph.vertices.push_back({static_cast<std::int64_t>(image.frame), image.world_from_camera, false});
  }
  if (!graph.vertices.empty()) graph.vertices.front().fixed = true;
  for (const SharedView& shared : shared_views(result, options)) {
    const std::size_t gap = map.images[shared.query].frame - map.images[shared.match].frame;
    Edge edge;
    edge.from = shared.match;
    edge.to = shared.query;
    edge.from_from_to = shared.match_from_query;
    edge.information = shared.information;
    edge.kind = gap > options.num_neighbours ? EdgeKind::Loop : EdgeKind::Neighbour;
    graph.edges.push_back(edge);
  }
  return graph;
}

InlierPixels shared_pixels(const Reconstructed& result, const ReconstructionGraphOptions& options) {
  const auto& images = result.reconstruction.images;
  InlierPixels pixels;
  for (const SharedView& shared : shared_views(result, options)) {
    const std::size_t query = images[shared.query].frame, match = images[shared.match].frame;
    if (query - match > options.num_neighbours) pixels[{query, match}];
  }
  for (const ScenePoint& point : result.reconstruction.points) {
    for (const Sighting& query : point.track) {
      for (const Sighting& match : point.track) {
        const auto loop = pixels.find({images[query.image].frame, images[match.image].frame});
        if (loop == pixels.end()) continue;
        const Eigen::Vector2f a = query.pixel.cast<float>(), b = match.pixel.cast<float>();
        loop->second.push_back({{a.x(), a.y()}, {b.x(), b.y()}});
      }
    }
  }
  return pixels;
}

std::vector<LoopEvent> reconstruction_loops(const Reconstructed& result, const ReconstructionGraphOptions& options) {
  const Reconstruction& map = result.reconstruction;
  const auto images = image_by_frame(map);
  std::map<std::pair<std::size_t, std::size_t>, SharedView> proven;
  for (const SharedView& shared : shared_views(result, options)) {
    proven[{map.images[shared.query].frame, map.images[shared.match].frame}] = shared;
  }
  const bool has_scale = map.unit == LengthUnit::Metres;
  std::map<std::size_t, LoopEvent> events;
  for (const FramePair& pair : result.pairs) {
    if (pair.query - pair.match <= options.num_neighbours) continue;
    LoopEvent& event = events[pair.query];
    event.query = pair.query;
    HypothesisOutcome outcome;
    outcome.match = pair.match;
    Verification& verification = outcome.verification;
    verification.num_inliers = static_cast<int>(pair.num_inliers);
    verification.num_matches = static_cast<int>(pair.num_matches);
    verification.median_parallax_deg = pair.median_parallax_deg;
    verification.verdict = Verdict::ContradictsMap;
    if (const auto at = proven.find({pair.query, pair.match}); at != proven.end()) {
      const SharedView& shared = at->second;
      verification.verdict = Verdict::Accepted;
      verification.num_point_inliers = static_cast<int>(shared.num_shared_points);
      verification.rms_error_px = shared.rms_error_px;
      verification.match_from_query = shared.match_from_query;
      verification.has_scale = has_scale;
      if (!has_scale) verification.match_from_query.translation.normalize();
      outcome.probability = 1;
      verification.p_true = 1;
    }
    event.hypotheses.push_back(outcome);
  }
  std::vector<LoopEvent> list;
  for (auto& [query, event] : events) {
    event.time_ns = images.contains(query) ? map.images[images.at(query)].time_ns : 0;
    list.push_back(std::move(event));
  }
  return list;
}

}  // namespace fabloop
