// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_event.h"

#include <gtest/gtest.h>

#include <random>

#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class LoopOfBodies : public testing::Test {
 protected:
  Vector6d random_vector() {
    std::normal_distribution<double> normal;
    Vector6d v;
    for (double& value : v) value = normal(random_);
    return v;
  }
  Pose random_pose() { return moved_by(random_vector()); }
  static Pose moved_by(const Vector6d& error) { return {rotation_from_vector(error.tail<3>()), error.head<3>()}; }
  HypothesisOutcome outcome() {
    HypothesisOutcome result;
    result.match = 4;
    result.match_session = 1;
    result.probability = 0.75;  // by appearance alone
    result.verification.p_true = 0.25;
    result.verification.verdict = Verdict::Accepted;
    result.verification.num_inliers = 77;
    result.verification.has_scale = true;
    result.verification.match_from_query = random_pose();
    Matrix6d root;
    for (int column = 0; column < 6; ++column) root.col(column) = random_vector();
    result.verification.information = root * root.transpose() + Matrix6d::Identity();
    return result;
  }
  std::mt19937_64 random_{3};
};

TEST_F(LoopOfBodies, KeepsWhatTheHypothesisSays) {
  const LoopClosure loop = loop_closure(9, outcome(), {}, {});
  EXPECT_EQ(loop.query, 9U);
  EXPECT_EQ(loop.match, 4U);
  EXPECT_EQ(loop.match_session, 1U);
  EXPECT_EQ(loop.probability, 0.25);
  EXPECT_EQ(loop.num_inliers, 77);
}

TEST_F(LoopOfBodies, AnErrorCostsTheSameForBodiesAsForCameras) {
  constexpr double kError = 1e-4;        // small, since covariances are of first order
  constexpr double kSecondOrder = 1e-2;  // of the cost, relative: the errors' size times some tens
  for (int trial = 0; trial < 100; ++trial) {
    const Pose query_body_from_camera = random_pose(), match_body_from_camera = random_pose();
    const HypothesisOutcome of_cameras = outcome();
    const LoopClosure loop = loop_closure(0, of_cameras, query_body_from_camera, match_body_from_camera);
    const Vector6d camera_error = kError * random_vector();
    const Pose true_pose = match_body_from_camera * of_cameras.verification.match_from_query * moved_by(camera_error) *
                           query_body_from_camera.inverse();
    const Vector6d body_error = pose_error(loop.match_from_query, true_pose);
    const double camera_cost = camera_error.dot(of_cameras.verification.information * camera_error);
    EXPECT_NEAR(body_error.dot(loop.information * body_error) / camera_cost, 1.0, kSecondOrder);
  }
}

TEST_F(LoopOfBodies, WithoutScaleOnlyAxesTurn) {
  for (int trial = 0; trial < 100; ++trial) {
    const Pose query_body_from_camera = random_pose(), match_body_from_camera = random_pose();
    HypothesisOutcome of_cameras = outcome();
    Verification& v = of_cameras.verification;
    v.has_scale = false;
    v.match_from_query.translation.normalize();
    Vector6d along = Vector6d::Zero();
    along.head<3>() = v.match_from_query.rotation.conjugate() * v.match_from_query.translation;
    const Matrix6d across = Matrix6d::Identity() - along * along.transpose();
    v.information = across * v.information * across;

    const LoopClosure loop = loop_closure(0, of_cameras, query_body_from_camera, match_body_from_camera);
    const Eigen::Quaterniond rotation =
        match_body_from_camera.rotation * v.match_from_query.rotation * query_body_from_camera.rotation.conjugate();
    EXPECT_LT(loop.match_from_query.rotation.angularDistance(rotation), 1e-9);
    EXPECT_LT((loop.match_from_query.translation - match_body_from_camera.rotation * v.match_from_query.translation).norm(),
              1e-9);
    Vector6d body_along = Vector6d::Zero();
    body_along.head<3>() = loop.match_from_query.rotation.conjugate() * loop.match_from_query.translation;
    EXPECT_LT((loop.information * body_along).norm(), 1e-9) << "the distance is still unknown";
    EXPECT_LT((loop.covariance * body_along).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace fabloop
