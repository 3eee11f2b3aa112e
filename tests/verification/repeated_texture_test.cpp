// SPDX-License-Identifier: BSD-3-Clause
#include "verification/repeated_texture.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/enlarged_view.h"
#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

std::vector<Match> right_matches(const TwoViews& world) {
  std::vector<Match> matches;
  for (int i = 0; i < static_cast<int>(world.pairs.size()); ++i) matches.push_back({i, i, 0.5F});
  return matches;
}

/// Features i and i + n/2 show one pattern, at different spots.
TwoViews world_of_twins(bool of_bits) {
  TwoViews world = make_two_views({.num_points = 300});
  cv::Mat descriptors = world.match.features.descriptors;
  if (of_bits) {
    descriptors.create(300, 32, CV_8U);
    cv::RNG(3).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  }
  descriptors.rowRange(0, 150).copyTo(descriptors.rowRange(150, 300));
  for (View* view : {&world.query, &world.match}) {
    view->features.descriptors = descriptors.clone();
    for (int i = 0; i < 300; ++i) {
      // The query's differs a little from both.
      if (of_bits && view == &world.query) view->features.descriptors.at<std::uint8_t>(i, i % 32) ^= 0b11;
      if (!of_bits && view == &world.query) view->features.descriptors.at<float>(i, i % 64) += 0.5F;
    }
  }
  return world;
}

TEST(RepeatedTexture, OfDistinctFeaturesIsNone) {
  const TwoViews world = make_two_views({.num_points = 120});
  const RepeatedTexture found = repeated_texture(world.query, world.match, right_matches(world), {.same_spot_px = 0.5});
  EXPECT_EQ(found.many_to_one_share, 0.0);
  EXPECT_EQ(found.mean_num_rivals, 0.0);
  EXPECT_EQ(found.lookalike_share, 0.0);
}

TEST(RepeatedTexture, SeesTwinsInFloatsAndBits) {
  for (const bool of_bits : {false, true}) {
    const TwoViews world = world_of_twins(of_bits);
    const RepeatedTexture found = repeated_texture(world.query, world.match, right_matches(world), {.same_spot_px = 0.5});
    EXPECT_EQ(found.mean_num_rivals, 1.0) << of_bits;
    EXPECT_EQ(found.lookalike_share, 1.0) << of_bits;
  }
}

TEST(RepeatedTexture, CountsMatchesThatShareASpot) {
  const TwoViews world = make_two_views({.num_points = 100});
  std::vector<Match> matches = right_matches(world);
  for (std::size_t i = 0; i < 30; ++i) matches[i].match = 5;
  const double share = repeated_texture(world.query, world.match, matches, {.same_spot_px = 0.01}).many_to_one_share;
  EXPECT_EQ(share, 0.3);
}

TEST(RepeatedTexture, SpotsOfAShrunkImageAreAsWideAsItsPixels) {
  const TwoViews world = make_two_views({.num_points = 300});
  const RepeatedTextureOptions options{.same_spot_px = 8};
  const double small = repeated_texture(world.query, world.match, right_matches(world), options).many_to_one_share;
  EXPECT_GT(small, 0.0);
  const View query = testing_support::enlarged(world.query, 4), match = testing_support::enlarged(world.match, 4);
  EXPECT_EQ(repeated_texture(query, match, right_matches(world), options).many_to_one_share, small);
}

TEST(RepeatedTexture, OfASampleIsLikeThatOfAll) {
  const TwoViews world = world_of_twins(false);
  const auto of = [&](int max_matches) {
    return repeated_texture(world.query, world.match, right_matches(world), {.same_spot_px = 0.5, .max_matches = max_matches});
  };
  EXPECT_EQ(of(20).mean_num_rivals, of(1000).mean_num_rivals);
}

TEST(RepeatedTexture, NoMatchesRepeatNothing) {
  const TwoViews world = make_two_views({.num_points = 20});
  EXPECT_EQ(repeated_texture(world.query, world.match, {}).lookalike_share, 0.0);
}

}  // namespace
}  // namespace fabloop
