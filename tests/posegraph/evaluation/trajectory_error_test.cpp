// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/trajectory_error.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

StampedPose at(double time_s, const Eigen::Vector3d& position, const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  return {static_cast<std::int64_t>(std::llround(time_s * 1e9)), {test::rotation_from_vector(turn), position}};
}

/// A square of 1 m, with the corner at (1, 1) lifted in the estimate.
const Trajectory kSquare = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {1, 1, 0}), at(3, {0, 1, 0})};

Trajectory moved(const Trajectory& trajectory, const Pose& pose, double scale = 1.0) {
  Trajectory result = trajectory;
  for (StampedPose& stamped : result) {
    stamped.world_from_camera.translation *= scale;
    stamped.world_from_camera = pose * stamped.world_from_camera;
  }
  return result;
}

Trajectory noisy(std::uint32_t seed) {
  test::CircleOptions options;
  options.sigma_translation_m = 0.1;
  options.sigma_rotation_rad = 0.05;
  options.seed = seed;
  Trajectory result;
  for (const Vertex& vertex : test::make_circle(options).graph.vertices)
    result.push_back({vertex.id * kSecond, vertex.world_from_frame});
  return result;
}

Trajectory exact() {
  Trajectory result;
  for (const Vertex& vertex : test::make_circle().truth.vertices)
    result.push_back({vertex.id * kSecond, vertex.world_from_frame});
  return result;
}

TEST(TrajectoryError, AbsoluteErrorsWithoutAlignmentAreTheDistances) {
  Trajectory estimate = kSquare;
  estimate[0].world_from_camera.translation.z() = 1.0;
  estimate[1].world_from_camera.translation.x() += 3.0;
  estimate[2].world_from_camera.translation.y() += 2.0;
  TrajectoryErrorOptions options;
  options.alignment = Alignment::None;
  const auto ate = absolute_trajectory_error(estimate, kSquare, options);
  ASSERT_TRUE(ate);
  // Errors 1, 3, 2, 0.
  EXPECT_DOUBLE_EQ(ate->translation_m.mean, 1.5);
  EXPECT_DOUBLE_EQ(ate->translation_m.median, 1.5);
  EXPECT_DOUBLE_EQ(ate->translation_m.max, 3.0);
  EXPECT_DOUBLE_EQ(ate->translation_m.rmse, std::sqrt(14.0 / 4.0));
  EXPECT_EQ(ate->translation_m.count, 4u);
}

TEST(TrajectoryError, AlignedErrorsOfAWarpedSquareAreKnown) {
  // Lifting two opposite corners by h leaves +-h/2 after the best alignment, which by symmetry only shifts by h/2.
  Trajectory estimate = kSquare;
  estimate[0].world_from_camera.translation.z() = 0.2;
  estimate[2].world_from_camera.translation.z() = 0.2;
  const auto ate = absolute_trajectory_error(estimate, kSquare);
  ASSERT_TRUE(ate);
  EXPECT_NEAR(ate->translation_m.rmse, 0.1, 1e-12);
  EXPECT_NEAR(ate->translation_m.max, 0.1, 1e-12);
}

TEST(TrajectoryError, RigidMotionsAndScaleAreAligned) {
  const Pose pose{test::rotation_from_vector({0.5, -1.0, 2.0}), {100.0, -50.0, 7.0}};
  const Trajectory reference = exact();
  const auto rigid = absolute_trajectory_error(moved(reference, pose), reference);
  ASSERT_TRUE(rigid);
  EXPECT_LT(rigid->translation_m.max, 1e-9);
  TrajectoryErrorOptions options;
  const auto scaled = absolute_trajectory_error(moved(reference, pose, 2.5), reference, options);
  ASSERT_TRUE(scaled);
  EXPECT_GT(scaled->translation_m.rmse, 1.0);
  options.alignment = Alignment::Sim3;
  const auto similar = absolute_trajectory_error(moved(reference, pose, 2.5), reference, options);
  ASSERT_TRUE(similar);
  EXPECT_LT(similar->translation_m.max, 1e-9);
  EXPECT_NEAR(similar->reference_from_estimate.scale, 0.4, 1e-12);
}

TEST(TrajectoryError, ErrorsDoNotDependOnTheFrameOfTheEstimate) {
  const Trajectory reference = exact();
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Trajectory estimate = noisy(seed);
    const Pose pose{test::rotation_from_vector({0.1 * seed, -1.0, 2.0}), {10.0 * seed, -50.0, 7.0}};
    const auto ate = absolute_trajectory_error(estimate, reference);
    const auto ate_moved = absolute_trajectory_error(moved(estimate, pose), reference);
    ASSERT_TRUE(ate && ate_moved);
    EXPECT_GT(ate->translation_m.rmse, 0.01);
    EXPECT_NEAR(ate->translation_m.rmse, ate_moved->translation_m.rmse, 1e-9);
    const auto rpe = relative_pose_error(estimate, reference);
    const auto rpe_moved = relative_pose_error(moved(estimate, pose), reference);
    ASSERT_TRUE(rpe && rpe_moved);
    EXPECT_NEAR(rpe->translation_m.rmse, rpe_moved->translation_m.rmse, 1e-9);
    EXPECT_NEAR(rpe->rotation_deg.rmse, rpe_moved->rotation_deg.rmse, 1e-6);
  }
}

TEST(TrajectoryError, AlignmentNeverMirrors) {
  Trajectory mirrored = exact();
  for (StampedPose& stamped : mirrored) stamped.world_from_camera.translation.z() *= -20.0;
  Trajectory reference = exact();
  for (StampedPose& stamped : reference) stamped.world_from_camera.translation.z() *= 20.0;
  const auto ate = absolute_trajectory_error(mirrored, reference);
  ASSERT_TRUE(ate);
  EXPECT_NEAR(ate->reference_from_estimate.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(ate->translation_m.rmse, 1.0);
}

TEST(TrajectoryError, RelativeErrorsAreThoseOfEachStep) {
  // Steps of 1 m; the second is 1.5 m long, the third turns by 0.1 rad too much.
  const Trajectory reference = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {2, 0, 0}), at(3, {3, 0, 0})};
  const Trajectory estimate = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {2.5, 0, 0}), at(3, {3.5, 0, 0}, {0, 0, 0.1})};
  const auto rpe = relative_pose_error(estimate, reference);
  ASSERT_TRUE(rpe);
  EXPECT_EQ(rpe->translation_m.count, 3u);
  EXPECT_NEAR(rpe->translation_m.rmse, 0.5 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(rpe->translation_m.max, 0.5, 1e-12);
  EXPECT_NEAR(rpe->translation_m.median, 0.0, 1e-12);
  EXPECT_NEAR(rpe->rotation_deg.max, deg_from_rad(0.1), 1e-9);
}

TEST(TrajectoryError, RelativeErrorsOverADistanceSpanStretches) {
  Trajectory reference;
  Trajectory estimate;
  for (int k = 0; k <= 15; ++k) {
    reference.push_back(at(k, {1.0 * k, 0, 0}));
    estimate.push_back(at(k, {1.1 * k, 0, 0}));
  }
  TrajectoryErrorOptions options;
  options.segment_length_m = 5.0;
  const auto rpe = relative_pose_error(estimate, reference, options);
  ASSERT_TRUE(rpe);
  EXPECT_EQ(rpe->translation_m.count, 2u) << "evo begins at the end of the first stretch";
  EXPECT_NEAR(rpe->translation_m.rmse, 0.5, 1e-9);
  options.alignment = Alignment::Sim3;
  EXPECT_NEAR(relative_pose_error(estimate, reference, options)->translation_m.rmse, 0.0, 1e-9);
  options.segment_length_m = 50.0;
  EXPECT_FALSE(relative_pose_error(estimate, reference, options));
}

TEST(TrajectoryError, AlignmentByYawLeavesTheTilt) {
  const Trajectory reference = exact();
  const Pose turned{test::rotation_from_vector({0.0, 0.0, 2.0}), {100.0, -50.0, 7.0}};
  TrajectoryErrorOptions options;
  options.alignment = Alignment::Yaw;
  EXPECT_LT(absolute_trajectory_error(moved(reference, turned), reference, options)->translation_m.max, 1e-9);
  const Pose tilted{test::rotation_from_vector({0.1, 0.0, 0.0}), Eigen::Vector3d::Zero()};
  EXPECT_GT(absolute_trajectory_error(moved(reference, tilted), reference, options)->translation_m.rmse, 0.1);
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Trajectory estimate = noisy(seed);
    const double best = absolute_trajectory_error(estimate, reference, options)->translation_m.rmse;
    // No other heading is better, and freedom to tilt is.
    for (const double yaw : {-0.01, 0.01}) {
      TrajectoryErrorOptions as_is;
      as_is.alignment = Alignment::None;
      const auto similarity = absolute_trajectory_error(estimate, reference, options)->reference_from_estimate;
      const Pose aligned{Eigen::Quaterniond(similarity.rotation), similarity.translation};
      const Pose about_mean = Pose{test::rotation_from_vector({0, 0, yaw}), Eigen::Vector3d::Zero()} * aligned;
      EXPECT_GT(absolute_trajectory_error(moved(estimate, about_mean), reference, as_is)->translation_m.rmse, best);
    }
    EXPECT_LE(absolute_trajectory_error(estimate, reference)->translation_m.rmse, best + 1e-12);
  }
}

/// evo's definitions once more, by other means: 4 x 4 matrices, and Horn's quaternion in place of Umeyama's decomposition.
struct EvoFigures {
  double ape_rmse = 0.0, rpe_rmse = 0.0, rpe_deg_rmse = 0.0;
};

EvoFigures by_other_means(const Trajectory& estimate, const Trajectory& reference, double segment_length_m) {
  const std::size_t size = estimate.size();
  std::vector<Eigen::Matrix4d> p(size, Eigen::Matrix4d::Identity());
  std::vector<Eigen::Matrix4d> q = p;
  Eigen::Vector3d mean_p = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_q = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < size; ++i) {
    p[i].topLeftCorner<3, 3>() = estimate[i].world_from_camera.rotation.toRotationMatrix();
    p[i].topRightCorner<3, 1>() = estimate[i].world_from_camera.translation;
    q[i].topLeftCorner<3, 3>() = reference[i].world_from_camera.rotation.toRotationMatrix();
    q[i].topRightCorner<3, 1>() = reference[i].world_from_camera.translation;
    mean_p += p[i].topRightCorner<3, 1>() / static_cast<double>(size);
    mean_q += q[i].topRightCorner<3, 1>() / static_cast<double>(size);
  }
  // Horn 1987: the rotation is the eigenvector of the largest eigenvalue.
  Eigen::Matrix4d n = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d a = p[i].topRightCorner<3, 1>() - mean_p;
    const Eigen::Vector3d b = q[i].topRightCorner<3, 1>() - mean_q;
    Eigen::Matrix4d left;
    Eigen::Matrix4d right;
    left << 0, -b.x(), -b.y(), -b.z(), b.x(), 0, -b.z(), b.y(), b.y(), b.z(), 0, -b.x(), b.z(), -b.y(), b.x(), 0;
    right << 0, -a.x(), -a.y(), -a.z(), a.x(), 0, a.z(), -a.y(), a.y(), -a.z(), 0, a.x(), a.z(), a.y(), -a.x(), 0;
    n += left.transpose() * right;
  }
  const Eigen::Vector4d best = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(0.5 * (n + n.transpose())).eigenvectors().col(3);
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(best(0), best(1), best(2), best(3)).toRotationMatrix();
  EvoFigures figures;
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d error = rotation * (p[i].topRightCorner<3, 1>() - mean_p) + mean_q - q[i].topRightCorner<3, 1>();
    figures.ape_rmse += error.squaredNorm() / static_cast<double>(size);
  }
  figures.ape_rmse = std::sqrt(figures.ape_rmse);
  std::vector<std::size_t> ids;
  double path = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    if (i > 0) path += (q[i].topRightCorner<3, 1>() - q[i - 1].topRightCorner<3, 1>()).norm();
    if (path < segment_length_m) continue;
    ids.push_back(i);
    path = 0.0;
  }
  for (std::size_t k = 1; k < ids.size(); ++k) {
    const Eigen::Matrix4d reference_step = q[ids[k - 1]].inverse() * q[ids[k]];
    const Eigen::Matrix4d error = reference_step.inverse() * (p[ids[k - 1]].inverse() * p[ids[k]]);
    const double angle_deg = deg_from_rad(std::acos(std::min(1.0, 0.5 * (error.topLeftCorner<3, 3>().trace() - 1.0))));
    figures.rpe_rmse += error.topRightCorner<3, 1>().squaredNorm() / static_cast<double>(ids.size() - 1);
    figures.rpe_deg_rmse += angle_deg * angle_deg / static_cast<double>(ids.size() - 1);
  }
  figures.rpe_rmse = std::sqrt(figures.rpe_rmse);
  figures.rpe_deg_rmse = std::sqrt(figures.rpe_deg_rmse);
  return figures;
}

TEST(TrajectoryError, FiguresAreEvosToAMillionth) {
  const Trajectory reference = exact();
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const Trajectory estimate = noisy(seed);
    TrajectoryErrorOptions options;
    options.segment_length_m = 7.0;
    const EvoFigures evo = by_other_means(estimate, reference, options.segment_length_m);
    EXPECT_NEAR(absolute_trajectory_error(estimate, reference)->translation_m.rmse, evo.ape_rmse, 1e-6);
    const auto rpe = relative_pose_error(estimate, reference, options);
    EXPECT_NEAR(rpe->translation_m.rmse, evo.rpe_rmse, 1e-6);
    EXPECT_NEAR(rpe->rotation_deg.rmse, evo.rpe_deg_rmse, 1e-6);
  }
}

TEST(TrajectoryError, PosesAreMatchedByTime) {
  const Trajectory estimate = {at(0.004, {0, 0, 0}), at(1.02, {1, 0, 0}), at(2.0, {2, 0, 0}), at(2.006, {3, 0, 0})};
  const Trajectory reference = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {2, 0, 0})};
  const auto pairs = associate(estimate, reference);
  ASSERT_EQ(pairs.size(), 2u) << "1.02 is too late, and the reference, which is shorter, has nothing nearer to 2.006";
  EXPECT_EQ(pairs[0].estimate.time_ns, estimate[0].time_ns);
  EXPECT_EQ(pairs[1].estimate.time_ns, estimate[2].time_ns);
  EXPECT_EQ(pairs[1].reference_from_camera.translation.x(), 2.0);
  EXPECT_EQ(associate(estimate, reference, 0.05).size(), 3u);
  EXPECT_EQ(associate(reference, estimate).size(), 2u);
  // Both poses of the shorter are nearest to the same of the longer: both count, as in evo.
  EXPECT_EQ(associate({at(1.996, {0, 0, 0}), at(2.004, {0, 0, 0})}, reference).size(), 2u);
  EXPECT_TRUE(associate({}, reference).empty());
}

TEST(TrajectoryError, TooFewPosesHaveNoError) {
  EXPECT_FALSE(absolute_trajectory_error({kSquare[0], kSquare[1]}, kSquare));
  EXPECT_FALSE(relative_pose_error({kSquare[0]}, kSquare));
  Trajectory point = kSquare;
  for (StampedPose& stamped : point) stamped.world_from_camera.translation.setZero();
  EXPECT_FALSE(absolute_trajectory_error(point, kSquare));
}

}  // namespace
}  // namespace fabloop
