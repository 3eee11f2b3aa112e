// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_event.h"

#include "verification/uncertain_pose.h"

namespace fabloop {

LoopClosure loop_closure(std::size_t query, const HypothesisOutcome& outcome, const Pose& query_body_from_camera,
                         const Pose& match_body_from_camera) {
  const Verification& verification = outcome.verification;
  // Where the distance is unknown, so is what the cameras' places on their bodies add to the direction.
  const auto turned_only = [](const Pose& pose) { return Pose{pose.rotation, Eigen::Vector3d::Zero()}; };
  const bool has_scale = verification.has_scale;
  const Pose query_camera_from_body = (has_scale ? query_body_from_camera : turned_only(query_body_from_camera)).inverse();
  const Pose& match = has_scale ? match_body_from_camera : turned_only(match_body_from_camera);

  LoopClosure loop;
  loop.query = query;
  loop.match = outcome.match;
  loop.match_session = outcome.match_session;
  loop.match_from_query = match * verification.match_from_query * query_camera_from_body;
  loop.has_scale = has_scale;
  // An error in the query's camera is Ad(body_from_camera) times as one in its body.
  const Eigen::Matrix<double, 6, 6> camera_error_from_body = adjoint(query_camera_from_body);
  loop.information = camera_error_from_body.transpose() * verification.information * camera_error_from_body;
  loop.covariance = covariance_of(loop.information);
  loop.num_inliers = verification.num_inliers;
  loop.probability = verification.p_true;
  return loop;
}

}  // namespace fabloop
