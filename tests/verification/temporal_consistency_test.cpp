// SPDX-License-Identifier: BSD-3-Clause
#include "verification/temporal_consistency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "frontend/error.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Keyframes on a curve, with an odometry and loops that err as their covariances say.
class Consistency : public testing::Test {
 protected:
  static constexpr std::size_t kFirstQuery = 50;  // which sees keyframe 0 again

  Vector6d draw(const Matrix6d& covariance) {
    std::normal_distribution<double> normal;
    Vector6d v;
    for (double& value : v) value = normal(random_);
    return Eigen::LLT<Matrix6d>(covariance).matrixL() * v;
  }
  static Pose moved_by(const Vector6d& error) { return {rotation_from_vector(error.tail<3>()), error.head<3>()}; }

  /// Covariances of steps and loops, anisotropic, for a walk of steps of `unit` metres.
  Matrix6d covariance(double translation, double rotation) const {
    Matrix6d result = Matrix6d::Zero();
    result.diagonal() << Eigen::Vector3d(1, 2, 0.5) * std::pow(translation * unit_, 2),
        Eigen::Vector3d(1, 0.5, 2) * std::pow(rotation, 2);
    return result;
  }
  Pose true_pose(std::size_t i) const {
    const double s = static_cast<double>(i);
    return {rotation_from_vector({0.02 * s, 0.01 * s, 0.1 * s}), unit_ * Eigen::Vector3d(s, std::sin(s), 0.1 * s)};
  }
  void walk_to(std::size_t last) {
    if (map_.sessions.empty()) map_.sessions.emplace_back();
    while (map_.keyframes.size() <= last) {
      const std::size_t i = map_.keyframes.size();
      MapKeyframe keyframe;
      keyframe.view.frame = 1000 + i;
      keyframe.step_covariance = covariance(0.02, 0.01);
      if (i > 0) {
        const Pose step = true_pose(i - 1).inverse() * true_pose(i) * moved_by(noise_ * draw(*keyframe.step_covariance));
        keyframe.odom_from_body = map_.keyframes.back().odom_from_body * step;
      }
      map_.keyframes.push_back(keyframe);
    }
  }
  /// The loop of query q to place m. Truth: query 50 + i passes place i at a distance.
  LoopClosure loop(std::size_t q, std::size_t m) {
    LoopClosure result;
    result.query = 1000 + q;
    result.match = 1000 + m;
    result.covariance = covariance(0.05, 0.005);
    result.has_scale = true;
    result.match_from_query = true_pose(m).inverse() * true_pose(q) * moved_by(noise_ * draw(result.covariance));
    return result;
  }
  static std::vector<std::size_t> queries(const std::vector<LoopClosure>& loops) {
    std::vector<std::size_t> result;
    for (const LoopClosure& loop : loops) result.push_back(loop.query - 1000);
    return result;
  }
  ConfirmedLoops add(TemporalConsistency& consistency, std::size_t query, const std::vector<std::size_t>& matches) {
    walk_to(query);
    std::vector<LoopClosure> loops;
    for (const std::size_t match : matches) loops.push_back(loop(query, match));
    return consistency.add(map_, loops);
  }

  static constexpr double kUsualLevel = 0.999;
  double unit_ = 1.0;
  double noise_ = 0.0;
  KeyframeMap map_;
  std::mt19937_64 random_{5};
};

TEST_F(Consistency, IsOffByDefault) {
  TemporalConsistency consistency;
  EXPECT_THAT(queries(add(consistency, 50, {0, 7, 30}).now), ElementsAre(50, 50, 50));
}

TEST_F(Consistency, ConfirmsAChainWithItsEarlierLoops) {
  TemporalConsistency consistency({.num_required = 3});
  for (std::size_t i = 0; i < 3; ++i) {
    const ConfirmedLoops confirmed = add(consistency, kFirstQuery + i, {i});
    EXPECT_THAT(queries(confirmed.now), IsEmpty());
    EXPECT_THAT(queries(confirmed.earlier), IsEmpty());
  }
  ConfirmedLoops confirmed = add(consistency, 53, {3});
  EXPECT_THAT(queries(confirmed.now), ElementsAre(53));
  EXPECT_THAT(queries(confirmed.earlier), ElementsAre(50, 51, 52));
  confirmed = add(consistency, 54, {4});
  EXPECT_THAT(queries(confirmed.now), ElementsAre(54));
  EXPECT_THAT(queries(confirmed.earlier), IsEmpty()) << "each loop is named once";
}

TEST_F(Consistency, ConfirmsAChainThatIsFlownBackwards) {
  TemporalConsistency consistency({.num_required = 2});
  add(consistency, 50, {20});
  add(consistency, 51, {19});
  const ConfirmedLoops confirmed = add(consistency, 52, {17});
  EXPECT_THAT(queries(confirmed.now), ElementsAre(52));
  EXPECT_THAT(queries(confirmed.earlier), ElementsAre(50, 51));
}

TEST_F(Consistency, ConfirmsAllLoopsOnAnyChainThatIsLongEnough) {
  TemporalConsistency consistency({.num_required = 2});
  add(consistency, 50, {0, 1});
  add(consistency, 51, {2, 3});
  const ConfirmedLoops confirmed = add(consistency, 52, {2, 4});
  EXPECT_THAT(queries(confirmed.now), ElementsAre(52, 52));
  EXPECT_THAT(queries(confirmed.earlier), ElementsAre(50, 50, 51, 51));
}

TEST_F(Consistency, BridgesMissedKeyframesAndNoMore) {
  TemporalConsistency consistency({.num_required = 1, .max_missed = 1});
  add(consistency, 50, {0});
  add(consistency, 51, {});
  EXPECT_THAT(queries(add(consistency, 52, {2}).now), ElementsAre(52));
  add(consistency, 53, {});
  add(consistency, 54, {});
  EXPECT_THAT(queries(add(consistency, 55, {5}).now), IsEmpty());
}

TEST_F(Consistency, PlacesFarApartDoNotConfirmEachOther) {
  TemporalConsistency consistency({.num_required = 1, .max_place_gap = 3});
  add(consistency, 50, {0});
  EXPECT_THAT(queries(add(consistency, 51, {4}).now), IsEmpty());
  EXPECT_THAT(queries(add(consistency, 52, {7}).now), ElementsAre(52));
}

TEST_F(Consistency, PlacesOfDifferentSessionsDoNotConfirmEachOther) {
  walk_to(20);
  for (MapKeyframe& keyframe : map_.keyframes) keyframe.session = 0;
  map_.sessions.resize(2);
  KeyframeMap later = map_;
  for (MapKeyframe keyframe : map_.keyframes) {
    keyframe.session = 1;
    later.keyframes.push_back(keyframe);
  }
  TemporalConsistency consistency({.num_required = 1});
  KeyframeMap until_19 = later;
  until_19.keyframes.pop_back();
  LoopClosure to_session_0 = loop(19, 0), to_session_1 = loop(20, 0), to_session_0_again = loop(20, 1);
  to_session_1.match_session = 1;
  consistency.add(until_19, {to_session_0});
  const ConfirmedLoops confirmed = consistency.add(later, {to_session_1, to_session_0_again});
  ASSERT_EQ(confirmed.now.size(), 1U);
  EXPECT_EQ(confirmed.now[0].match_session, 0U);
}

TEST_F(Consistency, RightLoopsAgreeAsOftenAsTheLevelSays) {
  noise_ = 1.0;
  constexpr int kTrials = 1500;
  constexpr double kLevel = 0.9;
  int num_agreeing = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    map_ = {};
    walk_to(21);
    num_agreeing += loops_agree(map_, loop(18, 2), loop(21, 5), kLevel);
  }
  // The share of n trials scatters by sqrt(p (1 - p) / n), 0.8 %; four of those are allowed.
  EXPECT_NEAR(static_cast<double>(num_agreeing) / kTrials, kLevel, 0.031);
}

TEST_F(Consistency, LoopsBesideTheOdometryDisagree) {
  noise_ = 1.0;
  walk_to(21);
  // Rotations of two loops and two steps are known to 0.02 rad together, which is 0.4 units at the end of a loop of 18 units:
  // 0.2 rad are ten standard deviations, 4 units too.
  for (int trial = 0; trial < 100; ++trial) {
    const LoopClosure first = loop(20, 2);
    LoopClosure aside = loop(21, 3), turned = loop(21, 3);
    aside.match_from_query.translation.x() += 4.0;
    turned.match_from_query.rotation = turned.match_from_query.rotation * rotation_from_vector({0, 0, 0.2});
    EXPECT_TRUE(loops_agree(map_, first, loop(21, 3), 0.99999));
    EXPECT_FALSE(loops_agree(map_, first, aside, kUsualLevel));
    EXPECT_FALSE(loops_agree(map_, first, turned, kUsualLevel));
  }
}

TEST_F(Consistency, WithoutScaleRotationsDecide) {
  walk_to(21);
  const LoopClosure first = loop(20, 2);
  LoopClosure second = loop(21, 3);
  second.has_scale = false;
  second.match_from_query.translation.setUnit(1);
  EXPECT_TRUE(loops_agree(map_, first, second, kUsualLevel));
  EXPECT_TRUE(loops_agree(map_, second, first, kUsualLevel));
  second.match_from_query.rotation = second.match_from_query.rotation * rotation_from_vector({0.2, 0, 0});
  EXPECT_FALSE(loops_agree(map_, first, second, kUsualLevel));
  EXPECT_FALSE(loops_agree(map_, second, first, kUsualLevel));
}

TEST_F(Consistency, DoesNotDependOnTheUnitOfLength) {
  noise_ = 1.6;  // so that many pairs disagree
  int num_agreeing = 0;
  for (unsigned trial = 0; trial < 100; ++trial) {
    std::vector<bool> agrees;
    for (const double unit : {1.0, 1000.0}) {
      unit_ = unit;
      random_.seed(trial);
      map_ = {};
      walk_to(21);
      const LoopClosure first = loop(18, 2), second = loop(21, 5);
      agrees.push_back(loops_agree(map_, first, second, 0.9));
    }
    EXPECT_EQ(agrees[0], agrees[1]);
    num_agreeing += agrees[0];
  }
  EXPECT_GT(num_agreeing, 10);
  EXPECT_LT(num_agreeing, 90);
}

TEST_F(Consistency, OdometryBetweenKeyframesIsTheirStepsOneByOne) {
  noise_ = 1.0;
  walk_to(12);
  const UncertainPose forth = odometry_between(map_, 3, 12), back = odometry_between(map_, 12, 3);
  const UncertainPose parts = odometry_between(map_, 3, 7) * odometry_between(map_, 7, 12);
  EXPECT_LT((forth.covariance - parts.covariance).norm(), 1e-12);
  EXPECT_LT(pose_error(forth.pose, map_.keyframes[3].odom_from_body.inverse() * map_.keyframes[12].odom_from_body).norm(), 1e-9);
  EXPECT_LT(pose_error(back.pose, forth.pose.inverse()).norm(), 1e-9);
  EXPECT_LT((inverse(back).covariance - forth.covariance).norm(), 1e-9);
  EXPECT_TRUE(odometry_between(map_, 5, 5).covariance.isZero());
}

TEST_F(Consistency, StepsWithoutCovarianceTakeTheNoiseOfTheOptions) {
  walk_to(3);
  map_.keyframes[3].step_covariance.reset();
  const double length = (map_.keyframes[2].odom_from_body.inverse() * map_.keyframes[3].odom_from_body).translation.norm();
  const UncertainPose step = odometry_between(map_, 2, 3, {.rotation_deg = 2, .translation = 0.1});
  EXPECT_NEAR(step.covariance(0, 0), std::pow(0.1 * length, 2), 1e-12);
  EXPECT_NEAR(step.covariance(5, 5), std::pow(rad_from_deg(2.0), 2), 1e-12);
}

TEST_F(Consistency, ALevelThatIsNoneIsRefused) {
  EXPECT_THROW(TemporalConsistency({.p_agree = 1.0}), InputError);
  EXPECT_THROW(TemporalConsistency({.p_agree = 0.0}), InputError);
}

}  // namespace
}  // namespace fabloop
