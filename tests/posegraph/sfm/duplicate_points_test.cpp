// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/duplicate_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include "posegraph/sfm/track_triangulation.h"
#include "tests/posegraph/sfm/synthetic_scene.h"
#include "tests/support/enlarged_view.h"

namespace fabloop {
namespace {

constexpr int kDimension = 32;

/// A flight whose points look each like themselves alone, and of which some are two tracks: those who saw them first, and the
/// rest.
struct SplitScene {
  explicit SplitScene(double noise_px = 0.5, std::uint64_t seed = 1, bool with_twins = false)
      : whole(test::make_synthetic_scene({.num_points = 1800, .noise_px = noise_px, .seed = seed})), random(seed) {
    if (with_twins) add_twins();
    describe();
    split();
    segment.world_from_cameras.assign(whole.world_from_cameras.begin(), whole.world_from_cameras.end());
    segment.points.resize(tracks.tracks.size());
    refresh_all_points({whole.views, tracks}, segment);
  }

  /// A point beside every fourth one, which the same views see 2.5 px away.
  void add_twins() {
    std::vector<Track> tracks_with_twins = whole.tracks.tracks;
    std::vector<Features> features;
    for (View& view : whole.views) features.push_back(std::move(view.features));
    for (std::size_t t = 0; t < whole.tracks.tracks.size(); t += 4) {
      Track twin;
      for (const TrackFeature& member : whole.tracks.tracks[t]) {
        std::vector<cv::KeyPoint>& keypoints = features[member.view].keypoints;
        cv::KeyPoint keypoint = keypoints[member.feature];
        keypoint.pt.x += 2.5F;
        twin.push_back({member.view, static_cast<std::uint32_t>(keypoints.size())});
        keypoints.push_back(keypoint);
      }
      tracks_with_twins.push_back(std::move(twin));
    }
    for (std::size_t v = 0; v < features.size(); ++v) whole.views[v] = make_view(v, whole.camera, std::move(features[v]));
    whole.tracks = index_tracks(std::move(tracks_with_twins), whole.views.size());
  }

  void describe() {
    std::normal_distribution<float> noise(0, 0.1F);
    for (View& view : whole.views)
      view.features.descriptors = cv::Mat::zeros(static_cast<int>(view.features.keypoints.size()), kDimension, CV_32F);
    for (const Track& track : whole.tracks.tracks) {
      std::vector<float> look(kDimension);
      for (float& value : look) value = 10 * noise(random);
      for (const TrackFeature& member : track) {
        float* row = whole.views[member.view].features.descriptors.ptr<float>(static_cast<int>(member.feature));
        for (int d = 0; d < kDimension; ++d) row[d] = look[static_cast<std::size_t>(d)] + noise(random);
      }
    }
  }

  void split() {
    std::vector<Track> parts;
    for (std::size_t t = 0; t < whole.tracks.tracks.size(); ++t) {
      const Track& track = whole.tracks.tracks[t];
      if (t % 3 != 0 || track.size() < 6) {
        parts.push_back(track);
        continue;
      }
      const auto middle = track.begin() + static_cast<std::ptrdiff_t>(track.size() / 2);
      parts.emplace_back(track.begin(), middle);
      parts.emplace_back(middle, track.end());
      ++num_split;
    }
    tracks = index_tracks(std::move(parts), whole.views.size());
  }

  /// Which point of the whole scene a feature shows.
  std::size_t point_of(const TrackFeature& member) const {
    for (std::size_t t = 0; t < whole.tracks.tracks.size(); ++t) {
      for (const TrackFeature& other : whole.tracks.tracks[t]) {
        if (other == member) return t;
      }
    }
    throw std::logic_error("a feature of no point");
  }

  test::SyntheticScene whole;
  std::mt19937_64 random;
  TrackSet tracks;
  Segment segment;
  std::size_t num_split = 0;
};

TEST(DuplicatePoints, TwoTracksOfOnePointBecomeOneAndNoOthersDo) {
  SplitScene scene;
  const std::size_t before = num_points(scene.segment);
  const std::size_t num_merged = merge_duplicate_points(scene.whole.views, scene.tracks, scene.segment);
  ASSERT_GT(scene.num_split, 100U);
  // Halves with little parallax are too vague to say, and 1 % lie further apart than the quantile.
  EXPECT_GE(num_merged, scene.num_split * 8 / 10);
  EXPECT_LE(num_merged, scene.num_split);
  EXPECT_EQ(num_points(scene.segment), before - num_merged);
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    const Track& track = scene.tracks.tracks[t];
    if (!scene.segment.points[t]) continue;
    ASSERT_TRUE(std::is_sorted(track.begin(), track.end()));
    const std::size_t point = scene.point_of(track.front());
    for (const TrackFeature& member : track) ASSERT_EQ(scene.point_of(member), point);
    EXPECT_LT((scene.segment.points[t]->x_in_world - scene.whole.points_in_world[point]).norm(), 0.5);
    for (const TrackFeature& member : track) {
      const auto& shown = scene.tracks.of_view[member.view];
      EXPECT_TRUE(std::binary_search(shown.begin(), shown.end(), t)) << "views know their tracks";
    }
  }
}

TEST(DuplicatePoints, AreTheSameInShrunkImages) {
  SplitScene small(1.0, 2, true), shrunk(1.0, 2, true);
  for (View& view : shrunk.whole.views) view = testing_support::enlarged(view, 4);
  const std::size_t expected = merge_duplicate_points(small.whole.views, small.tracks, small.segment);
  const std::size_t found = merge_duplicate_points(shrunk.whole.views, shrunk.tracks, shrunk.segment);
  ASSERT_GT(expected, 100U);
  // Keypoints are floats, so that a few pairs at a threshold may fall on its other side.
  EXPECT_NEAR(static_cast<double>(found), static_cast<double>(expected), 0.01 * static_cast<double>(expected));
}

TEST(DuplicatePoints, MergingAgainFindsNothing) {
  SplitScene scene;
  merge_duplicate_points(scene.whole.views, scene.tracks, scene.segment);
  EXPECT_LE(merge_duplicate_points(scene.whole.views, scene.tracks, scene.segment), scene.num_split / 100);
}

TEST(DuplicatePoints, WhatLooksDifferentStaysTwo) {
  SplitScene scene;
  for (View& view : scene.whole.views) {
    cv::Mat& descriptors = view.features.descriptors;
    cv::RNG random(view.frame + 1);
    random.fill(descriptors, cv::RNG::NORMAL, 0, 1);
  }
  // Each track looks the same throughout and like no other.
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    for (const TrackFeature& member : scene.tracks.tracks[t]) {
      cv::Mat row = scene.whole.views[member.view].features.descriptors.row(static_cast<int>(member.feature));
      cv::RNG(t + 1000).fill(row, cv::RNG::NORMAL, 0, 1);
    }
  }
  EXPECT_EQ(merge_duplicate_points(scene.whole.views, scene.tracks, scene.segment), 0U);
}

TEST(DuplicatePoints, WhatAViewSeesAtTwoSpotsStaysTwo) {
  // Noisy sightings, so that covariances reach far, and the same look everywhere: views alone tell neighbours apart, here twins
  // some 10 cm (2.5 px) from every fourth point.
  SplitScene scene(1.5, 3, true);
  for (View& view : scene.whole.views) view.features.descriptors.setTo(1.0F);
  ASSERT_GT(num_points(scene.segment), 1000U);
  merge_duplicate_points(scene.whole.views, scene.tracks, scene.segment);
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    if (!scene.segment.points[t]) continue;
    std::set<std::size_t> points;
    for (const TrackFeature& member : scene.tracks.tracks[t]) points.insert(scene.point_of(member));
    EXPECT_EQ(points.size(), 1U);
  }
}

}  // namespace
}  // namespace fabloop
