// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/growth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "posegraph/sfm/georeference.h"
#include "posegraph/sfm/segments.h"
#include "tests/posegraph/sfm/synthetic_scene.h"
#include "tests/support/enlarged_view.h"

namespace fabloop {
namespace {

using test::centre_error;
using test::make_synthetic_scene;
using test::pairs_of;
using test::SyntheticScene;
using test::SyntheticSceneOptions;

GrowthOptions single_thread() {
  GrowthOptions options;
  options.triangulation.num_threads = options.start.triangulation.num_threads = 1;
  return options;
}

/// Two flights as one scene; with `num_shared` tracks of the first flight also seen, at the right place, by the second.
SyntheticScene side_by_side(const SyntheticScene& a, const SyntheticScene& b) {
  SyntheticScene both = a;
  const auto first = static_cast<std::uint32_t>(a.views.size());
  std::vector<Track> tracks = a.tracks.tracks;
  for (const View& view : b.views) {
    both.views.push_back(view);
    both.views.back().frame = both.views.size() - 1;
  }
  both.world_from_cameras.insert(both.world_from_cameras.end(), b.world_from_cameras.begin(), b.world_from_cameras.end());
  for (Track track : b.tracks.tracks) {
    for (TrackFeature& member : track) member.view += first;
    tracks.push_back(track);
  }
  both.tracks = index_tracks(tracks, both.views.size());
  return both;
}

TEST(Growth, PlacesEveryViewExactlyWithoutNoise) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const SyntheticScene scene = make_synthetic_scene({.num_points = 300, .seed = seed});
    const auto segments = build_segments(scene.scene(), pairs_of(scene), single_thread());
    ASSERT_EQ(segments.size(), 1U);
    EXPECT_EQ(num_placed(segments[0]), scene.views.size());
    // Growth stops its adjustments at a share of 1e-5 of the cost; 1e-3 is 0.03 px at this height.
    EXPECT_LT(centre_error(scene, segments[0].world_from_cameras), 1e-3);
    EXPECT_LT(reprojection_statistics(scene.scene(), segments[0]).mean_px, 0.05);
  }
}

TEST(Growth, LeavesWrongTrackMembersOut) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 400, .noise_px = 0.3, .wrong_share = 0.1, .seed = 3});
  const auto segments = build_segments(scene.scene(), pairs_of(scene), single_thread());
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(num_placed(segments[0]), scene.views.size());
  // 0.3 px are 0.012 at this height.
  EXPECT_LT(centre_error(scene, segments[0].world_from_cameras), 0.03);
  EXPECT_LT(reprojection_statistics(scene.scene(), segments[0]).mean_px, 0.6);
}

TEST(Growth, TreatsShrunkImagesAsImagesOfThatSize) {
  constexpr double kTimes = 4;
  const SyntheticScene small = make_synthetic_scene({.num_points = 400, .noise_px = 1.0, .wrong_share = 0.1, .seed = 3});
  SyntheticScene shrunk = small;
  for (View& view : shrunk.views) view = testing_support::enlarged(view, kTimes);
  const auto expected = build_segments(small.scene(), pairs_of(small), single_thread());
  const auto found = build_segments(shrunk.scene(), pairs_of(shrunk), single_thread());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(num_placed(found[0]), num_placed(expected[0]));
  // Keypoints are floats, so that a sighting at the very threshold may fall on its other side.
  EXPECT_NEAR(static_cast<double>(num_points(found[0])), static_cast<double>(num_points(expected[0])), 2);
  EXPECT_NEAR(reprojection_statistics(shrunk.scene(), found[0]).mean_px,
              kTimes * reprojection_statistics(small.scene(), expected[0]).mean_px, 0.02);
  EXPECT_NEAR(centre_error(small, found[0].world_from_cameras), centre_error(small, expected[0].world_from_cameras), 0.002);
}

TEST(Growth, ReportsTwoFlightsThatShareNothingAsTwoSegments) {
  const SyntheticScene both = side_by_side(make_synthetic_scene({.num_strips = 2, .num_points = 300, .seed = 4}),
                                           make_synthetic_scene({.num_strips = 1, .num_points = 200, .east = 1000, .seed = 5}));
  auto segments = build_segments(both.scene(), pairs_of(both), single_thread());
  segments = join_segments(both.scene(), std::move(segments), {.growth = single_thread()});
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(num_placed(segments[0]), 10U);
  EXPECT_EQ(num_placed(segments[1]), 5U);
  for (std::size_t view = 0; view < 10; ++view) EXPECT_TRUE(segments[0].world_from_cameras[view]);
}

TEST(Segments, JoinOverSharedPointsWhateverTheirWorldsAndUnits) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 400, .noise_px = 0.2, .seed = 6});
  const GrowthOptions growth = single_thread();
  std::vector<Segment> segments;
  // Each half grows on its own; half of the views are not the other's to place.
  for (const bool first : {true, false}) {
    std::vector<char> may_be_placed(scene.views.size(), 0);
    std::vector<ViewPair> pairs = pairs_of(scene);
    const auto is_of_half = [&](std::size_t view) { return (view < 8) == first; };
    for (std::size_t view = 0; view < scene.views.size(); ++view) may_be_placed[view] = is_of_half(view);
    std::erase_if(pairs, [&](const ViewPair& pair) { return !is_of_half(pair.query) || !is_of_half(pair.match); });
    auto segment = start_segment(scene.scene(), pairs[start_order(pairs)[0]], growth.start);
    ASSERT_TRUE(segment);
    grow(scene.scene(), *segment, may_be_placed, scene.views.size(), growth);
    segments.push_back(std::move(*segment));
  }
  move_segment(segments[1], 7.5, {rotation_from_vector({0.4, 1.0, -2.0}), {100, 50, -30}});
  const auto joined = join_segments(scene.scene(), std::move(segments), {.growth = growth});
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(num_placed(joined[0]), scene.views.size());
  EXPECT_LT(centre_error(scene, joined[0].world_from_cameras), 0.03);
}

TEST(Growth, DoesNotDependOnTheNumberOfThreads) {
  const SyntheticScene scene = make_synthetic_scene({.num_points = 300, .noise_px = 0.3, .seed = 7});
  GrowthOptions three = single_thread();
  three.triangulation.num_threads = three.start.triangulation.num_threads = 3;
  const auto a = build_segments(scene.scene(), pairs_of(scene), single_thread());
  const auto b = build_segments(scene.scene(), pairs_of(scene), three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    EXPECT_EQ(a[0].world_from_cameras[view]->translation, b[0].world_from_cameras[view]->translation);
  }
}

TEST(StartOrder, PrefersParallaxAndPutsAmbiguousPlanesLast) {
  ViewPair narrow, good, ambiguous, turn;
  for (ViewPair* pair : {&narrow, &good, &ambiguous, &turn}) pair->inliers.resize(100);
  narrow.median_parallax_deg = 3;
  good.median_parallax_deg = 10;
  ambiguous.median_parallax_deg = 12;
  ambiguous.has_rival = true;
  turn.median_parallax_deg = 10;
  turn.rotation_share = 0.95;
  EXPECT_EQ(start_order({narrow, ambiguous, turn, good}), (std::vector<std::size_t>{3, 0, 1}));
}

TEST(MeetingPoint, IsWhereRaysMeetAndNowhereWhenTheyAreParallel) {
  const Eigen::Vector3d x(1, 2, 10);
  const std::vector<Eigen::Vector3d> centres{{0, 0, 0}, {3, 0, 0}, {0, 4, 1}};
  std::vector<Eigen::Vector3d> rays;
  for (const auto& centre : centres) rays.push_back((x - centre).normalized());
  EXPECT_LT((*meeting_point(centres, rays) - x).norm(), 1e-9);
  EXPECT_FALSE(meeting_point({{0, 0, 0}, {1, 0, 0}}, {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ()}));
}

}  // namespace
}  // namespace fabloop
