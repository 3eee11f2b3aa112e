// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/track_triangulation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// A track's placed views: position in the track, centre and ray in the world.
struct PlacedRays {
  std::vector<std::uint32_t> positions;
  std::vector<Eigen::Vector3d> centres, rays;
};

PlacedRays placed_rays(const Scene& scene, const Segment& segment, const Track& track) {
  PlacedRays placed;
  for (std::uint32_t i = 0; i < track.size(); ++i) {
    if (!segment.world_from_cameras[track[i].view]) continue;
    const Pose world_from_camera = pose_at_sighting(scene, segment, track[i]);
    placed.positions.push_back(i);
    placed.centres.push_back(world_from_camera.translation);
    placed.rays.push_back(world_from_camera.rotation * scene.views[track[i].view].rays[track[i].feature]);
  }
  return placed;
}

std::vector<std::uint32_t> agreeing(const Scene& scene, const Segment& segment, const Track& track, const PlacedRays& placed,
                                    const Eigen::Vector3d& x_in_world, double max_error_px) {
  std::vector<std::uint32_t> positions;
  for (const std::uint32_t i : placed.positions) {
    if (sighting_error_px(scene, segment, track[i], x_in_world) <= max_error_px) positions.push_back(i);
  }
  return positions;
}

/// Largest angle between the directions from the point to those who see it.
double parallax_rad(const Segment& segment, const Track& track, const SegmentPoint& point) {
  double largest = 0;
  std::vector<Eigen::Vector3d> directions;
  for (const std::uint32_t i : point.seen_by) {
    directions.push_back((segment.world_from_cameras[track[i].view]->translation - point.x_in_world).normalized());
    for (const Eigen::Vector3d& other : directions) largest = std::max(largest, (other - directions.back()).norm());
  }
  return 2.0 * std::asin(std::min(1.0, 0.5 * largest));
}

/// The point again from those who see it, when that leaves it its support.
SegmentPoint refined(const Scene& scene, const Segment& segment, const Track& track, const PlacedRays& placed, SegmentPoint point,
                     double max_error_px) {
  std::vector<Eigen::Vector3d> centres, rays;
  for (std::size_t k = 0; k < placed.positions.size(); ++k) {
    if (!std::binary_search(point.seen_by.begin(), point.seen_by.end(), placed.positions[k])) continue;
    centres.push_back(placed.centres[k]);
    rays.push_back(placed.rays[k]);
  }
  const auto again = meeting_point(centres, rays);
  if (!again) return point;
  auto seen_by = agreeing(scene, segment, track, placed, *again, max_error_px);
  if (seen_by.size() < point.seen_by.size()) return point;
  return {*again, std::move(seen_by)};
}

bool is_supported(const Segment& segment, const Track& track, const SegmentPoint& point,
                  const TrackTriangulationOptions& options) {
  return point.seen_by.size() >= 2 && parallax_rad(segment, track, point) >= rad_from_deg(options.min_parallax_deg);
}

}  // namespace

std::optional<Eigen::Vector3d> meeting_point(const std::vector<Eigen::Vector3d>& centres,
                                             const std::vector<Eigen::Vector3d>& rays) {
  constexpr double kLeastCurvature = 1e-8;  // of the normal equations: rays parallel to some 1e-4 rad
  constexpr int kRounds = 2;                // the first without weights
  std::vector<double> weights(rays.size(), 1.0);
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double total = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Matrix3d across = weights[i] * (Eigen::Matrix3d::Identity() - rays[i] * rays[i].transpose());
      normal += across;
      right += across * centres[i];
      total += weights[i];
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (!(solver.vectorD().minCoeff() > kLeastCurvature * total)) return std::nullopt;
    x = solver.solve(right);
    for (std::size_t i = 0; i < rays.size(); ++i) weights[i] = 1.0 / std::max((x - centres[i]).squaredNorm(), 1e-12);
  }
  return x;
}

std::optional<SegmentPoint> triangulate_track(const Scene& scene, const Segment& segment, std::size_t track_index,
                                              const TrackTriangulationOptions& options) {
  constexpr std::size_t kMaxPairs = 30;
  const Track& track = scene.tracks.tracks[track_index];
  const PlacedRays placed = placed_rays(scene, segment, track);
  const std::size_t count = placed.positions.size();
  if (count < 2) return std::nullopt;
  // Wide gaps in the track first: they have parallax.
  SegmentPoint best;
  std::size_t num_tried = 0;
  for (std::size_t gap = count - 1; gap > 0; --gap) {
    for (std::size_t a = 0; a + gap < count && num_tried < kMaxPairs; ++a) {
      const std::size_t b = a + gap;
      if (angle_between(placed.rays[a], placed.rays[b]) < rad_from_deg(options.min_parallax_deg)) continue;
      ++num_tried;
      const auto x = meeting_point({placed.centres[a], placed.centres[b]}, {placed.rays[a], placed.rays[b]});
      if (!x) continue;
      auto seen_by = agreeing(scene, segment, track, placed, *x, options.max_error_px);
      if (seen_by.size() > best.seen_by.size()) best = {*x, std::move(seen_by)};
      if (best.seen_by.size() == count) num_tried = kMaxPairs;
    }
  }
  if (best.seen_by.size() < 2) return std::nullopt;
  best = refined(scene, segment, track, placed, std::move(best), options.max_error_px);
  if (!is_supported(segment, track, best, options)) return std::nullopt;
  return best;
}

void refresh_points(const Scene& scene, Segment& segment, const std::vector<std::uint32_t>& tracks,
                    const TrackTriangulationOptions& options) {
  constexpr std::size_t kChunk = 256;
  parallel_for((tracks.size() + kChunk - 1) / kChunk, options.num_threads, [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(tracks.size(), (chunk + 1) * kChunk); ++i) {
      const Track& track = scene.tracks.tracks[tracks[i]];
      auto& point = segment.points[tracks[i]];
      if (point) {
        const PlacedRays placed = placed_rays(scene, segment, track);
        point->seen_by = agreeing(scene, segment, track, placed, point->x_in_world, options.max_error_px);
        if (is_supported(segment, track, *point, options)) continue;
      }
      point = triangulate_track(scene, segment, tracks[i], options);
    }
  });
}

void refresh_all_points(const Scene& scene, Segment& segment, const TrackTriangulationOptions& options) {
  std::vector<std::uint32_t> all(scene.tracks.tracks.size());
  std::iota(all.begin(), all.end(), 0U);
  refresh_points(scene, segment, all, options);
}

}  // namespace fabloop
