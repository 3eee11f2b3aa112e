// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <opencv2/core.hpp>

#include "tests/support/enlarged_view.h"
#include "tests/verification/two_view_world.h"
#include "verification/pair_seed.h"
#include "verification/pose/planar_ambiguity.h"

namespace fabloop {
namespace {

using testing_support::enlarged;
using testing_support::make_two_views;
using testing_support::TwoViews;

TEST(Verifier, AcceptsAMetricLoopWhereDepthIsKnown) {
  const TwoViews world = make_two_views({.outlier_ratio = 0.3, .noise_px = 0.5, .with_points = true, .depth_noise = 0.02});
  const Verification found = Verifier().verify(world.query, world.match);
  ASSERT_EQ(found.verdict, Verdict::Accepted) << to_string(found.verdict);
  EXPECT_TRUE(found.has_scale);
  EXPECT_LT((found.match_from_query.translation - world.match_from_query.translation).norm(), 0.1);  // 1 % of the depth
  EXPECT_GT(found.num_inliers, 100);
  EXPECT_EQ(found.num_inliers, static_cast<int>(found.inliers.size()));
}

TEST(Verifier, JudgesShrunkImagesAsImagesOfThatSize) {
  constexpr double kTimes = 4;
  for (const bool with_points : {false, true}) {
    const TwoViews world = make_two_views({.outlier_ratio = 0.3, .noise_px = 1.0, .with_points = with_points});
    const Verification small = Verifier().verify(world.query, world.match);
    const Verification shrunk = Verifier().verify(enlarged(world.query, kTimes), enlarged(world.match, kTimes));
    ASSERT_EQ(small.verdict, Verdict::Accepted);
    EXPECT_EQ(shrunk.verdict, Verdict::Accepted);
    EXPECT_EQ(shrunk.num_inliers, small.num_inliers);
    EXPECT_EQ(shrunk.num_point_inliers, small.num_point_inliers);
    // Keypoints are floats.
    EXPECT_NEAR(shrunk.rms_error_px, small.rms_error_px, 1e-3);
    EXPECT_NEAR(shrunk.log10_false_alarms, small.log10_false_alarms, 1e-6);
    EXPECT_LT((shrunk.match_from_query.translation - small.match_from_query.translation).norm(), 1e-3);
  }
}

TEST(Verifier, PointsOfTheQueryServeAsWell) {
  TwoViews world = make_two_views({.noise_px = 0.5, .with_points = true});
  const Verification forward = Verifier().verify(world.query, world.match);
  const Verification backward = Verifier().verify(world.match, world.query);
  ASSERT_EQ(forward.verdict, Verdict::Accepted);
  ASSERT_EQ(backward.verdict, Verdict::Accepted);
  const Pose difference = forward.match_from_query * backward.match_from_query;
  EXPECT_LT(difference.translation.norm(), 0.05);
  EXPECT_LT(deg_from_rad(rotation_angle(difference.rotation)), 0.2);
}

TEST(Verifier, WithoutDepthALoopIsADirection) {
  const TwoViews world = make_two_views({.noise_px = 0.5});
  const Verification found = Verifier().verify(world.query, world.match);
  ASSERT_EQ(found.verdict, Verdict::Accepted) << to_string(found.verdict);
  EXPECT_FALSE(found.has_scale);
  EXPECT_NEAR(found.match_from_query.translation.norm(), 1.0, 1e-12);
  // No information along the direction, in the query's axes.
  const Eigen::Vector3d along = found.match_from_query.rotation.conjugate() * found.match_from_query.translation;
  const Eigen::Matrix3d translation_information = found.information.topLeftCorner<3, 3>();
  EXPECT_LT((translation_information * along).norm(), 1e-9 * translation_information.trace());
}

TEST(Verifier, ALengthIsAsVagueAsTheUnitOfItsPoints) {
  TwoViews world = make_two_views({.noise_px = 0.5, .with_points = true});
  const double sure = Verifier().verify(world.query, world.match).scale_sigma;
  EXPECT_GE(sure, VerifierOptions{}.scale_sigma);
  world.match.unit_sigma = 0.14;
  VerifierOptions lax;
  lax.max_distance_sigma = 1;
  const Verification vague = Verifier(lax).verify(world.query, world.match);
  ASSERT_EQ(vague.verdict, Verdict::Accepted);
  EXPECT_GE(vague.scale_sigma, 0.14);
  const Eigen::Vector3d along = (vague.match_from_query.rotation.conjugate() * vague.match_from_query.translation).normalized();
  const Eigen::Matrix3d covariance = vague.information.inverse().topLeftCorner<3, 3>();
  EXPECT_GE(std::sqrt(along.dot(covariance * along)), 0.14 * vague.match_from_query.translation.norm() * (1 - 1e-9));
}

TEST(Verifier, InformationIsSymmetricAndPositive) {
  const TwoViews world = make_two_views({.noise_px = 0.5, .with_points = true});
  const auto information = Verifier().verify(world.query, world.match).information;
  EXPECT_TRUE(information.isApprox(information.transpose(), 1e-12));
  EXPECT_GT((Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(information).eigenvalues()(0)), 0);
}

TEST(Verifier, TooFewMatchesIsAVerdict) {
  const TwoViews world = make_two_views({.num_points = 12});
  EXPECT_EQ(Verifier().verify(world.query, world.match).verdict, Verdict::TooFewMatches);
}

TEST(Verifier, RandomMatchesAreNeverAccepted) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const TwoViews world = make_two_views({.num_points = 150, .outlier_ratio = 1.0, .seed = seed});
    const Verdict verdict = Verifier().verify(world.query, world.match).verdict;
    EXPECT_TRUE(verdict == Verdict::NoPose || verdict == Verdict::TooFewInliers || verdict == Verdict::AccidentalInliers)
        << to_string(verdict);
  }
}

TEST(Verifier, FewInliersAmongMatchesIsAVerdict) {
  const TwoViews world = make_two_views({.num_points = 40, .outlier_ratio = 0.8, .noise_px = 0.5, .seed = 2});
  EXPECT_EQ(Verifier().verify(world.query, world.match).verdict, Verdict::TooFewInliers);
}

TEST(Verifier, InliersThatChanceExplainsAreAccidental) {
  VerifierOptions options;
  options.min_inliers = 6;
  const TwoViews world = make_two_views({.num_points = 150, .outlier_ratio = 1.0, .seed = 3});
  EXPECT_EQ(Verifier(options).verify(world.query, world.match).verdict, Verdict::AccidentalInliers);
}

TEST(Verifier, ARotationWithoutDepthHasNoParallax) {
  const TwoViews world = make_two_views({.noise_px = 0.3, .baseline = 0.01});
  EXPECT_EQ(Verifier().verify(world.query, world.match).verdict, Verdict::NoParallax);
}

TEST(Verifier, ARotationWithDepthIsALoop) {
  const TwoViews world = make_two_views({.noise_px = 0.3, .baseline = 0.01, .with_points = true});
  const Verification found = Verifier().verify(world.query, world.match);
  EXPECT_EQ(found.verdict, Verdict::Accepted) << to_string(found.verdict);
  EXPECT_LT((found.match_from_query.translation - world.match_from_query.translation).norm(), 0.1);
}

TEST(Verifier, PointsThatContradictTheRaysAreToldApart) {
  TwoViews world = make_two_views({.with_points = true, .depth_noise = 0.7, .seed = 5});
  EXPECT_EQ(Verifier().verify(world.query, world.match).verdict, Verdict::ScaleDisagrees);
}

TEST(Verifier, NoiseLeavesThePosePoorlyConstrained) {
  VerifierOptions options;
  options.max_rotation_sigma = 1e-4;
  const TwoViews world = make_two_views({.noise_px = 0.8, .with_points = true});
  EXPECT_EQ(Verifier(options).verify(world.query, world.match).verdict, Verdict::PoorlyConstrained);
}

TEST(Verifier, APlaneWithTwoPosesIsAmbiguous) {
  // Whether both poses lie in front of the cameras depends on the view; over many, some must be ambiguous, and none that is
  // accepted may be wrong.
  int ambiguous = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViews world = make_two_views({.num_points = 120, .noise_px = 0.5, .planar = true, .seed = seed});
    const Verification found = Verifier().verify(world.query, world.match);
    ambiguous += found.verdict == Verdict::AmbiguousPose;
    if (found.verdict != Verdict::Accepted) continue;
    EXPECT_LT(deg_from_rad(angle_between(found.match_from_query.translation, world.match_from_query.translation)), 15) << seed;
    EXPECT_LT(deg_from_rad(found.match_from_query.rotation.angularDistance(world.match_from_query.rotation)), 5) << seed;
  }
  EXPECT_GT(ambiguous, 0);
}

/// Odometry that knows the rotation to 5 degrees and the direction to 10, at the truth.
PosePrior prior_at(const Pose& match_from_query) {
  PosePrior prior{match_from_query};
  const double translation_sigma = rad_from_deg(10) * match_from_query.translation.norm();
  prior.covariance.topLeftCorner<3, 3>() *= translation_sigma * translation_sigma;
  prior.covariance.bottomRightCorner<3, 3>() *= rad_from_deg(5) * rad_from_deg(5);
  return prior;
}

TEST(Verifier, OdometryTellsThePosesOfAPlaneApart) {
  int num_resolved = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViews world = make_two_views({.num_points = 120, .noise_px = 0.5, .planar = true, .seed = seed});
    const bool was_ambiguous = Verifier().verify(world.query, world.match).verdict == Verdict::AmbiguousPose;
    const Verification found = Verifier().verify(world.query, world.match, {prior_at(world.match_from_query)});
    if (!was_ambiguous || found.verdict != Verdict::Accepted) continue;
    ++num_resolved;
    EXPECT_LT(deg_from_rad(found.match_from_query.rotation.angularDistance(world.match_from_query.rotation)), 5) << seed;
  }
  EXPECT_GT(num_resolved, 0);
}

TEST(Verifier, PointsTellThePosesOfAPlaneApart) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViews world = make_two_views(
        {.num_points = 120, .noise_px = 0.5, .planar = true, .with_points = true, .depth_noise = 0.02, .seed = seed});
    const Verification found = Verifier().verify(world.query, world.match);
    EXPECT_EQ(found.verdict, Verdict::Accepted) << seed << ": " << to_string(found.verdict);
    EXPECT_LT((found.match_from_query.translation - world.match_from_query.translation).norm(), 0.3) << seed;
  }
}

void append(View& view, const View& other) {
  auto& keypoints = view.features.keypoints;
  keypoints.insert(keypoints.end(), other.features.keypoints.begin(), other.features.keypoints.end());
  cv::vconcat(view.features.descriptors, other.features.descriptors, view.features.descriptors);
  view = make_view(view.frame, view.camera, view.features);
}

TEST(Verifier, TextureThatRepeatsIsToldApart) {
  // Two sets of matches, each with a pose of its own.
  const TwoViews first = make_two_views({.num_points = 100, .seed = 1});
  const TwoViews second = make_two_views({.num_points = 100, .seed = 2});
  TwoViews both = first;
  append(both.query, second.query);
  append(both.match, second.match);
  const Verification found = Verifier().verify(both.query, both.match);
  EXPECT_EQ(found.verdict, Verdict::RepeatedTexture) << to_string(found.verdict);
  EXPECT_GT(found.num_second_inliers, 60);
}

void set_angles(View& view, float angle_deg) {
  for (cv::KeyPoint& keypoint : view.features.keypoints) keypoint.angle = angle_deg;
}

TEST(Verifier, TextureThatRepeatsTurnedIsToldApartByTheSecondLook) {
  // The smaller set turned otherwise: the second look leaves it out of its matches, and yet must see that it has a pose.
  TwoViews both = make_two_views({.num_points = 110, .seed = 1});
  TwoViews second = make_two_views({.num_points = 100, .seed = 2});
  set_angles(both.query, 0);
  set_angles(both.match, 10);
  set_angles(second.query, 0);
  set_angles(second.match, 120);
  append(both.query, second.query);
  append(both.match, second.match);
  const Verification found = Verifier().verify(both.query, both.match);
  EXPECT_EQ(found.verdict, Verdict::RepeatedTexture) << to_string(found.verdict);
}

TEST(Verifier, LooksAgainWithAllFeaturesWhereTheFirstProveNothing) {
  const TwoViews world = make_two_views({.num_points = 300, .outlier_ratio = 0.3, .noise_px = 0.3, .with_points = true});
  VerifierOptions options;
  options.second_look.num_first_features = 16;
  const Verification found = Verifier(options).verify(world.query, world.match);
  EXPECT_EQ(found.verdict, Verdict::Accepted) << to_string(found.verdict);
  EXPECT_EQ(found.num_looks, 2);
  EXPECT_GT(found.num_matches, 200);
  options.second_look.min_similar = 25;  // more than there are in the first look
  const Verification once = Verifier(options).verify(world.query, world.match);
  EXPECT_EQ(once.num_looks, 1);
  EXPECT_NE(once.verdict, Verdict::Accepted);
}

TEST(Verifier, LooksAgainWhereTheFirstFeaturesProveThinly) {
  const TwoViews world = make_two_views({.num_points = 300, .outlier_ratio = 0.3, .noise_px = 0.3, .with_points = true});
  VerifierOptions options;
  options.second_look.num_first_features = 40;
  options.second_look.min_true = 10;
  const Verification thin = Verifier(options).verify(world.query, world.match);
  ASSERT_EQ(thin.verdict, Verdict::Accepted) << to_string(thin.verdict);
  EXPECT_EQ(thin.num_looks, 1);
  options.second_look.min_true = VerifierOptions().second_look.min_true;
  ASSERT_LT(thin.num_true, options.second_look.min_true);
  const Verification sure = Verifier(options).verify(world.query, world.match);
  EXPECT_EQ(sure.verdict, Verdict::Accepted) << to_string(sure.verdict);
  EXPECT_EQ(sure.num_looks, 2);
  EXPECT_GT(sure.num_true, 3 * thin.num_true);
  EXPECT_LT(sure.rotation_sigma_deg, thin.rotation_sigma_deg);
}

/// Gives all features of the match but the first `num_distinct` a double elsewhere that looks about as much like the query's.
TwoViews with_doubles(TwoViews world, int num_distinct) {
  cv::RNG random(1);
  Features features = world.match.features;
  const int count = features.descriptors.rows, size = features.descriptors.cols;
  const auto noisy = [&](const cv::Mat& descriptor) {
    constexpr double kNoise = 0.2;  // of a descriptor's own scatter
    cv::Mat noise(1, size, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, kNoise);
    return cv::Mat(descriptor + noise);
  };
  for (int i = num_distinct; i < count; ++i) {
    const cv::Mat original = world.query.features.descriptors.row(i);
    noisy(original).copyTo(features.descriptors.row(i));
    features.descriptors.push_back(noisy(original));
    features.keypoints.emplace_back(random.uniform(0.0F, 639.0F), random.uniform(0.0F, 479.0F), 3.0F);
  }
  world.match = make_view(world.match.frame, world.match.camera, features);
  return world;
}

TEST(Verifier, GuidedMatchesMakeAProvenPoseMoreCertain) {
  const TwoViews world = with_doubles(make_two_views({.num_points = 300, .noise_px = 0.5}), 60);
  VerifierOptions options;
  options.second_look.min_similar = 1000;  // none
  const Verification plain = Verifier(options).verify(world.query, world.match);
  ASSERT_EQ(plain.verdict, Verdict::Accepted) << to_string(plain.verdict);
  const double field_of_view_rad = 2 * std::atan(0.5 * std::hypot(640, 480) / 500);
  options.max_rotation_sigma = 0.7 * rad_from_deg(plain.rotation_sigma_deg) / field_of_view_rad;
  const Verification vague = Verifier(options).verify(world.query, world.match);
  EXPECT_EQ(vague.verdict, Verdict::PoorlyConstrained) << to_string(vague.verdict);
  options.guided = true;
  const Verification guided = Verifier(options).verify(world.query, world.match);
  EXPECT_EQ(guided.verdict, Verdict::Accepted) << to_string(guided.verdict);
  EXPECT_GT(guided.num_inliers, 2 * plain.num_inliers);
  EXPECT_EQ(guided.log10_false_alarms, vague.log10_false_alarms) << "guided matches prove nothing";
  EXPECT_LT(deg_from_rad(guided.match_from_query.rotation.angularDistance(world.match_from_query.rotation)), 0.5);
}

TEST(Verifier, InliersInACornerAreAVerdict) {
  const TwoViews world = make_two_views({.num_points = 1500});
  Features query, match;
  for (int i = 0; i < 1500; ++i) {
    const auto& keypoint = world.query.features.keypoints[static_cast<std::size_t>(i)];
    if (keypoint.pt.x > 320 || keypoint.pt.y > 240) continue;
    query.keypoints.push_back(keypoint);
    match.keypoints.push_back(world.match.features.keypoints[static_cast<std::size_t>(i)]);
    query.descriptors.push_back(world.query.features.descriptors.row(i));
    match.descriptors.push_back(world.match.features.descriptors.row(i));
  }
  VerifierOptions options;
  options.min_inlier_area = 0.3;
  ASSERT_GT(query.keypoints.size(), 20U);
  const Verification found =
      Verifier(options).verify(make_view(1, world.query.camera, query), make_view(0, world.match.camera, match));
  EXPECT_EQ(found.verdict, Verdict::InliersInCorner) << to_string(found.verdict);
}

TEST(Verifier, AProbabilityThatIsAskedForIsAGate) {
  VerifierOptions options;
  options.max_log10_false_alarms = 0;
  options.min_probability = 0.999;
  const TwoViews world = make_two_views({.num_points = 80, .outlier_ratio = 0.5, .noise_px = 0.2, .seed = 4});
  const PairPrior unlikely{.p_appearance = 0.02};
  const Verification found = Verifier(options).verify(world.query, world.match, unlikely);
  options.min_probability = 0;
  const Verification without = Verifier(options).verify(world.query, world.match, unlikely);
  ASSERT_EQ(without.verdict, Verdict::Accepted) << to_string(without.verdict);
  EXPECT_EQ(found.p_true, without.p_true);
  EXPECT_EQ(found.verdict, found.p_true < 0.999 ? Verdict::Improbable : Verdict::Accepted);
  options.min_probability = 1.0 - 1e-12;
  EXPECT_EQ(Verifier(options).verify(world.query, world.match, unlikely).verdict, Verdict::Improbable);
}

TEST(Verifier, WhatContradictsOdometryIsLessProbable) {
  const TwoViews world = make_two_views({.noise_px = 0.5, .with_points = true});
  Pose elsewhere = world.match_from_query;
  elsewhere.translation += Eigen::Vector3d(20, 0, 0);
  const double agreeing = Verifier().verify(world.query, world.match, {prior_at(world.match_from_query)}).p_true;
  const double contradicting = Verifier().verify(world.query, world.match, {prior_at(elsewhere)}).p_true;
  EXPECT_LT(contradicting, agreeing);
}

TEST(Verifier, SeedsDependOnBothFramesAndTheirOrder) {
  EXPECT_NE(pair_seed(1, 2, 3), pair_seed(1, 3, 2));
  EXPECT_NE(pair_seed(1, 2, 3), pair_seed(2, 2, 3));
  EXPECT_EQ(pair_seed(1, 2, 3), pair_seed(1, 2, 3));
}

}  // namespace
}  // namespace fabloop
