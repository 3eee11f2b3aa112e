// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/guided_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/verification/two_view_world.h"
#include "verification/matching/epipolar_pencil.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

Eigen::Vector3d random_unit_vector(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// Every pattern is seen `num_points / num_patterns` times in the world: rows of crops, windows.
void repeat_texture(TwoViews& world, int num_patterns, float noise) {
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  cv::Mat1f patterns(num_patterns, 64);
  for (float& value : patterns) value = normal(random);
  for (View* view : {&world.query, &world.match}) {
    cv::Mat1f descriptors(static_cast<int>(view->rays.size()), patterns.cols);
    for (int i = 0; i < descriptors.rows; ++i) {
      for (int c = 0; c < patterns.cols; ++c) descriptors(i, c) = patterns(i % num_patterns, c) + noise * normal(random);
    }
    view->features.descriptors = descriptors;
  }
}

std::size_t count_true(const std::vector<Match>& matches) {
  return static_cast<std::size_t>(
      std::count_if(matches.begin(), matches.end(), [](const Match& m) { return m.query == m.match; }));
}

/// Candidates by the definition.
std::vector<int> candidates_by_definition(const Eigen::Vector3d& query_ray, const std::vector<Eigen::Vector3d>& match_rays,
                                          const Pose& match_from_query, double max_error_rad) {
  const Eigen::Vector3d t = match_from_query.translation.normalized();
  const Eigen::Matrix3d essential = cross_matrix(t) * match_from_query.rotation.toRotationMatrix();
  const Eigen::Vector3d turned = match_from_query.rotation * query_ray;
  std::vector<int> found;
  for (std::size_t i = 0; i < match_rays.size(); ++i) {
    const Eigen::Vector3d& ray = match_rays[i];
    const double e = ray.dot(essential * query_ray);
    const double gradient = (essential * query_ray).squaredNorm() + (essential.transpose() * ray).squaredNorm() - 2 * e * e;
    if (std::abs(e) > max_error_rad * std::sqrt(gradient)) continue;
    const double cosine = turned.dot(ray);
    const bool in_front = ray.dot(t) > cosine * turned.dot(t) && cosine * ray.dot(t) > turned.dot(t);
    if (in_front || (turned - ray).norm() < 2 * max_error_rad) found.push_back(static_cast<int>(i));
  }
  return found;
}

TEST(EpipolarPencil, FindsTheCandidatesOfTheDefinition) {
  std::mt19937_64 random(11);
  std::size_t num_candidates = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Eigen::Vector3d> rays;
    // All round, and in narrow cones in which the epipole may lie.
    const Eigen::Vector3d axis = random_unit_vector(random);
    const double cone = trial % 3 == 0 ? 100.0 : (trial % 3 == 1 ? 0.5 : 0.05);
    for (int i = 0; i < 400; ++i) rays.push_back((axis + cone * random_unit_vector(random)).normalized());
    const Eigen::Vector3d direction = trial % 2 == 0 ? axis : random_unit_vector(random);
    const Pose match_from_query{rotation_from_vector(3.0 * random_unit_vector(random)), 7.0 * direction};
    const double max_error_rad = trial % 5 == 0 ? 0.05 : 0.004;
    const EpipolarPencil pencil(rays, match_from_query, max_error_rad);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d near_some = (rays[static_cast<std::size_t>(i)] + 0.003 * random_unit_vector(random)).normalized();
      const Eigen::Vector3d query_ray =
          match_from_query.rotation.conjugate() * (i % 2 == 0 ? near_some : random_unit_vector(random));
      std::vector<int> found;
      pencil.candidates(query_ray, found);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, candidates_by_definition(query_ray, rays, match_from_query, max_error_rad)) << trial << ", " << i;
      num_candidates += found.size();
    }
  }
  EXPECT_GT(num_candidates, 10000u);
}

TEST(GuidedMatching, FindsWhatRepeatedTextureHides) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    TwoViews world = make_two_views({.num_points = 400, .noise_px = 0.5, .seed = seed});
    repeat_texture(world, 20, 0.2F);
    const auto unguided = match_features(world.query.features, world.match.features);
    const auto guided = guided_matches(world.query, world.match, world.match_from_query);
    EXPECT_GT(count_true(guided), 4 * count_true(unguided)) << seed;
    EXPECT_GT(count_true(guided), 200u) << seed;
    // A look-alike in the band at the wrong depth is all that can deceive it, where noise hid the true one.
    EXPECT_GT(static_cast<double>(count_true(guided)), 0.9 * static_cast<double>(guided.size())) << seed;
  }
}

TEST(GuidedMatching, FindsEveryPairOfDistinctFeatures) {
  const TwoViews world = make_two_views({.num_points = 300});
  const auto matches = guided_matches(world.query, world.match, world.match_from_query, {.same_spot_px = 0});
  EXPECT_EQ(matches.size(), 300u);
  EXPECT_EQ(count_true(matches), 300u);
}

TEST(GuidedMatching, LeavesOutWhatIsOffThePlane) {
  // Same descriptors, but the pixels of the outliers have nothing to do with the pose.
  const TwoViews world = make_two_views({.num_points = 400, .outlier_ratio = 0.5});
  EXPECT_EQ(match_features(world.query.features, world.match.features, {.same_spot_px = 0}).size(), 400u);
  const std::size_t found = guided_matches(world.query, world.match, world.match_from_query).size();
  EXPECT_GT(found, 190u);
  EXPECT_LT(found, 230u);
}

TEST(GuidedMatching, TakesNothingThatLooksUnlike) {
  TwoViews world = make_two_views({.num_points = 300});
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 300; ++i) {
    for (int c = 0; c < 64; ++c) world.query.features.descriptors.at<float>(i, c) = normal(random);
  }
  // Random descriptors are seldom so near to each other, though bands of one feature have no second to compare with.
  EXPECT_LT(guided_matches(world.query, world.match, world.match_from_query).size(), 6u);
}

TEST(GuidedMatching, KeepsToTheChangeOfViewWhereItIsGiven) {
  TwoViews world = make_two_views({.num_points = 200});
  for (std::size_t i = 0; i < 200; ++i) {
    world.query.features.keypoints[i].angle = 30;
    world.match.features.keypoints[i].angle = i < 120 ? 210.0F : 100.0F;
  }
  const auto all = guided_matches(world.query, world.match, world.match_from_query, {.same_spot_px = 0});
  EXPECT_EQ(all.size(), 200u);
  const ViewChange change = view_change(world.query.features, world.match.features, all);
  ASSERT_TRUE(change.turn_deg);
  EXPECT_NEAR(change.turn_deg->value, 180, 1e-3);
  const auto turned =
      guided_matches(world.query, world.match, world.match_from_query, {.same_spot_px = 0, .change = change, .consistency = {}});
  EXPECT_EQ(turned.size(), 120u);
  for (const Match& match : turned) EXPECT_LT(match.query, 120);
}

TEST(GuidedMatching, ComparesBits) {
  TwoViews world = make_two_views({.num_points = 200});
  cv::Mat1b bits(200, 32);
  cv::RNG(3).fill(bits, cv::RNG::UNIFORM, 0, 256);
  for (View* view : {&world.query, &world.match}) {
    view->features.descriptor_kind = DescriptorKind::Orb;
    view->features.descriptors = bits;
  }
  const auto matches = guided_matches(world.query, world.match, world.match_from_query);
  EXPECT_GT(matches.size(), 190u);
  EXPECT_EQ(count_true(matches), matches.size());
}

TEST(GuidedMatching, NothingMatchesNothing) {
  EXPECT_TRUE(guided_matches({}, {}, {Eigen::Quaterniond::Identity(), Eigen::Vector3d::UnitX()}).empty());
}

}  // namespace
}  // namespace fabloop
