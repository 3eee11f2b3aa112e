// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/sfm/bundle_adjustment.h"
#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/view_graph.h"

namespace fabloop::test {

struct SyntheticSceneOptions {
  std::size_t num_strips = 3;
  std::size_t views_per_strip = 5;
  std::size_t num_points = 600;
  double relief = 3;         ///< Largest height of the ground over a height of flight of 20.
  double tilt_deg = 8;       ///< Of the cameras off the vertical, at random.
  double height_change = 2;  ///< Of the flight, at random.
  double noise_px = 0;
  double wrong_share = 0;  ///< Of the track members, how many show another spot.
  double east = 0;         ///< Where the flight begins.
  std::uint64_t seed = 1;
};

/// A flight in strips over ground with relief, seen through tracks as matching would give them. No images, no descriptors.
struct SyntheticScene {
  Camera camera;
  std::vector<Pose> world_from_cameras;
  std::vector<Eigen::Vector3d> points_in_world;  ///< By track.
  std::vector<View> views;
  TrackSet tracks;
  Scene scene() const { return {views, tracks}; }
};

inline Camera synthetic_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion = {-0.05, 0.01, 0.001, -0.001, 0.0};
  return camera;
}

inline std::vector<Pose> synthetic_flight(const SyntheticSceneOptions& options, std::mt19937_64& random) {
  constexpr double kHeight = 20;
  constexpr double kSpacing = 5;   // of 26 that a view sees: 80 % overlap
  constexpr double kStripGap = 8;  // of 19
  std::uniform_real_distribution<double> unit(-1, 1);
  const Eigen::Quaterniond down(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  std::vector<Pose> poses;
  for (std::size_t strip = 0; strip < options.num_strips; ++strip) {
    for (std::size_t i = 0; i < options.views_per_strip; ++i) {
      const std::size_t along = strip % 2 == 0 ? i : options.views_per_strip - 1 - i;
      const Eigen::Vector3d tilt = rad_from_deg(options.tilt_deg) * Eigen::Vector3d(unit(random), unit(random), unit(random));
      poses.push_back({down * rotation_from_vector(tilt),
                       {options.east + kSpacing * static_cast<double>(along), kStripGap * static_cast<double>(strip),
                        kHeight + options.height_change * unit(random)}});
    }
  }
  return poses;
}

inline SyntheticScene make_synthetic_scene(const SyntheticSceneOptions& options = {}) {
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> noise(0, 1);
  std::uniform_real_distribution<double> share(0, 1);
  SyntheticScene result;
  result.camera = synthetic_camera();
  result.world_from_cameras = synthetic_flight(options, random);
  std::vector<Features> features(result.world_from_cameras.size());
  std::vector<Track> tracks;
  const double length = 5.0 * static_cast<double>(options.views_per_strip) + 20;
  const double width = 8.0 * static_cast<double>(options.num_strips) + 16;
  for (std::size_t p = 0; p < options.num_points; ++p) {
    const Eigen::Vector3d x(options.east - 12 + length * share(random), -12 + width * share(random),
                            options.relief * share(random));
    Track track;
    for (std::size_t view = 0; view < features.size(); ++view) {
      const auto pixel = project(result.camera, result.world_from_cameras[view].inverse() * x);
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > 639 || pixel->y() > 479) continue;
      const bool is_wrong = share(random) < options.wrong_share;
      Eigen::Vector2d seen = *pixel + options.noise_px * Eigen::Vector2d(noise(random), noise(random));
      if (is_wrong) seen = {639 * share(random), 479 * share(random)};
      track.push_back({static_cast<std::uint32_t>(view), static_cast<std::uint32_t>(features[view].keypoints.size())});
      features[view].keypoints.emplace_back(cv::Point2f(static_cast<float>(seen.x()), static_cast<float>(seen.y())), 3.0F);
    }
    if (track.size() < 2) continue;
    tracks.push_back(track);
    result.points_in_world.push_back(x);
  }
  // Tracks come sorted, as build_tracks() gives them; points follow.
  std::vector<std::pair<Track, Eigen::Vector3d>> both;
  for (std::size_t t = 0; t < tracks.size(); ++t) both.emplace_back(tracks[t], result.points_in_world[t]);
  std::sort(both.begin(), both.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t t = 0; t < both.size(); ++t) result.points_in_world[t] = both[t].second;
  result.tracks = index_tracks(std::move(tracks), features.size());
  for (std::size_t view = 0; view < features.size(); ++view) {
    result.views.push_back(make_view(view, result.camera, std::move(features[view])));
  }
  return result;
}

/// Pairs that share tracks, as verification would prove them, with their true relative pose.
inline std::vector<ViewPair> pairs_of(const SyntheticScene& scene, std::size_t min_shared = 40) {
  std::vector<ViewPair> pairs;
  for (std::size_t query = 0; query < scene.views.size(); ++query) {
    for (std::size_t match = 0; match < query; ++match) {
      ViewPair pair;
      pair.query = query;
      pair.match = match;
      std::vector<double> parallaxes;
      for (const Track& track : scene.tracks.tracks) {
        const auto q = position_in(track, query);
        const auto m = position_in(track, match);
        if (!q || !m) continue;
        pair.inliers.push_back({static_cast<int>(track[*q].feature), static_cast<int>(track[*m].feature), 0.5F});
      }
      if (pair.inliers.size() < min_shared) continue;
      pair.match_from_query = scene.world_from_cameras[match].inverse() * scene.world_from_cameras[query];
      const double baseline = pair.match_from_query.translation.norm();
      pair.match_from_query.translation /= baseline;
      pair.median_parallax_deg = deg_from_rad(baseline / 20);
      pairs.push_back(pair);
    }
  }
  return pairs;
}

/// RMS distance of the placed cameras from the truth after Sim(3) alignment; the flight's height is 20.
inline double centre_error(const SyntheticScene& truth, const std::vector<std::optional<Pose>>& world_from_cameras) {
  Eigen::Matrix3Xd estimate(3, 0), reference(3, 0);
  for (std::size_t i = 0; i < world_from_cameras.size(); ++i) {
    if (!world_from_cameras[i]) continue;
    estimate.conservativeResize(3, estimate.cols() + 1);
    reference.conservativeResize(3, reference.cols() + 1);
    estimate.rightCols<1>() = world_from_cameras[i]->translation;
    reference.rightCols<1>() = truth.world_from_cameras[i].translation;
  }
  const auto by = align_points(estimate, reference, Alignment::Sim3);
  double squares = 0;
  for (Eigen::Index i = 0; i < estimate.cols(); ++i) squares += (*by * estimate.col(i) - reference.col(i)).squaredNorm();
  return std::sqrt(squares / static_cast<double>(reference.cols()));
}

}  // namespace fabloop::test
