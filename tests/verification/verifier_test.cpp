// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/verification/two_view_world.h"
#include "verification/planar_ambiguity.h"

namespace fabloop {
namespace {

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
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TwoViews world = make_two_views({.num_points = 120, .noise_px = 0.5, .planar = true, .seed = seed});
    const Verification found = Verifier().verify(world.query, world.match);
    ambiguous += found.verdict == Verdict::AmbiguousPose;
    if (found.verdict != Verdict::Accepted) continue;
    EXPECT_LT(deg_from_rad(angle_between(found.match_from_query.translation, world.match_from_query.translation)), 15) << seed;
    EXPECT_LT(deg_from_rad(found.match_from_query.rotation.angularDistance(world.match_from_query.rotation)), 5) << seed;
  }
  EXPECT_GT(ambiguous, 0);
}

TEST(Verifier, SeedsDependOnBothFramesAndTheirOrder) {
  EXPECT_NE(pair_seed(1, 2, 3), pair_seed(1, 3, 2));
  EXPECT_NE(pair_seed(1, 2, 3), pair_seed(2, 2, 3));
  EXPECT_EQ(pair_seed(1, 2, 3), pair_seed(1, 2, 3));
}

}  // namespace
}  // namespace fabloop
