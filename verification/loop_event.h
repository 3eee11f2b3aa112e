// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/neighbour.h"
#include "verification/verifier.h"

namespace fabloop {

/// A place that the image may show, and what became of it.
struct HypothesisOutcome {
  std::size_t match = 0;          ///< Keyframe::frame of the place.
  std::size_t match_session = 0;  ///< Where that keyframe is from: see LoopEvent::session.
  double probability = 0;
  double log_likelihood = 0;
  Verification verification;  ///< Of the cameras. LoopClosure has the same for the bodies.
  /// What the map's back end makes of a loop that it was given: the squared whitened error, and the robust weight, 1 for one that
  /// is believed fully. Only a map can tell.
  std::optional<double> map_chi2 = {}, map_weight = {};
};

/// A proven loop as a host's pose graph takes it: the pose of one body in another.
struct LoopClosure {
  std::size_t query = 0;          ///< Keyframe::frame.
  std::size_t match = 0;          ///< Keyframe::frame.
  std::size_t match_session = 0;  ///< See LoopEvent::session.
  /// Of the bodies, in the odometry's unit of length. Without scale the translation is the unit direction from camera to camera
  /// in the match's body axes: how far the cameras are from their bodies does not count where the distance is unknown.
  Pose match_from_query;
  bool has_scale = false;
  /// Of (translation, rotation) of match_from_query in the query's axes: match_from_query_true = match_from_query * error.
  /// Without scale it has no information along the direction, and the translation's part is of the unit direction.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< covariance_of(information).
  int num_inliers = 0;
  double probability = 0;  ///< That the loop is right: Verification::p_true.
};

/// Seconds spent on one keyframe.
struct LoopCloserTimes {
  double features_s = 0;   ///< Where an image was given.
  double words_s = 0;      ///< Descriptors to words.
  double recognise_s = 0;  ///< Posterior and ranking.
  double neighbour_s = 0;  ///< Link and triangulation.
  double verify_s = 0;     ///< All hypotheses.
};

/// Everything that one keyframe led to.
struct LoopEvent {
  std::size_t query = 0;  ///< Keyframe::frame.
  std::int64_t time_ns = 0;
  std::size_t session = 0;                    ///< Of the query: 0, or how many sessions the earlier map has.
  double p_new = 1;                           ///< Probability that the place was never seen before, neighbours in time left out.
  std::vector<HypothesisOutcome> hypotheses;  ///< The ledger, most probable first; accepted ones have Verdict::Accepted.
  std::vector<LoopClosure> loops;             ///< This keyframe's accepted hypotheses.
  /// Loops of earlier keyframes that this one confirmed: their verdict was Verdict::Unconfirmed. See ConsistencyOptions.
  std::vector<LoopClosure> confirmed;
  std::vector<NeighbourLink> neighbours;  ///< What the images say about the way from earlier keyframes, nearest first.
  /// Positions in LoopCloser::map().keyframes that are new or whose points have changed: what a map file must be told.
  std::vector<std::size_t> changed;
  LoopCloserTimes times;
};

/// The loop of an accepted hypothesis, for the bodies that carry the cameras.
LoopClosure loop_closure(std::size_t query, const HypothesisOutcome& outcome, const Pose& query_body_from_camera,
                         const Pose& match_body_from_camera);

}  // namespace fabloop
