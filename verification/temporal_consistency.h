// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "verification/loop_event.h"
#include "verification/map/keyframe_map.h"

namespace fabloop {

/// When a proven loop is believed: once enough consecutive keyframes have proven loops to nearby places whose poses agree through
/// the odometry. A false loop, of ground that looks alike, rarely moves along with the camera.
struct ConsistencyOptions {
  /// So many other keyframes in a row must say the same before a loop is handed out; the first ones of a revisit come late. 0:
  /// every loop at once. 2 or 3 where one false loop costs more than a few right ones.
  std::size_t num_required = 0;
  /// So many keyframes in between may have no such loop. More where loops are rare.
  std::size_t max_missed = 1;
  /// How many keyframes apart the places of two consecutive loops may be. Further apart the odometry between them says little.
  std::size_t max_place_gap = 10;
  /// Two right loops agree with this probability: a level of the chi-square test.
  double p_agree = 0.999;
};

/// Loops that may be believed by now.
struct ConfirmedLoops {
  std::vector<LoopClosure> now;      ///< Of the last keyframe.
  std::vector<LoopClosure> earlier;  ///< Of keyframes before it, in their order; each loop is named once.
};

/// Keeps the loops of the last keyframes until enough others agree. A loop is confirmed once it lies on a chain of
/// `num_required + 1` keyframes in which every two consecutive loops agree.
class TemporalConsistency {
 public:
  /// Throws InputError when `p_agree` is not in (0, 1).
  explicit TemporalConsistency(const ConsistencyOptions& options = {}, const OdometryStepNoise& odometry = {});

  /// Adds the proven loops of the last keyframe of the map; call it after every keyframe, with or without loops.
  ConfirmedLoops add(const KeyframeMap& map, const std::vector<LoopClosure>& loops);

 private:
  struct Candidate {
    LoopClosure loop;
    std::size_t query = 0, match = 0;       ///< Positions in the map.
    std::vector<std::size_t> predecessors;  ///< Numbers of those of earlier keyframes that agree.
    std::size_t chain_before = 0;           ///< Keyframes in the longest chain that leads here.
    std::size_t chain_after = 0;            ///< The same for the chain that goes on from here.
    bool is_confirmed = false;
  };

  Candidate& candidate(std::size_t number) { return candidates_[number - num_forgotten_]; }
  void forget_before(std::size_t query);
  Candidate linked(const KeyframeMap& map, const LoopClosure& loop) const;
  void lengthen_chains_to(const Candidate& last);

  ConsistencyOptions options_;
  OdometryStepNoise odometry_;
  std::deque<Candidate> candidates_;  ///< Of the last keyframes; each has a number, counted from the first ever.
  std::size_t num_forgotten_ = 0;
};

/// Whether two loops of keyframes of one session, to places of one session, can both be right: the pose that the first one and
/// the odometry predict for the second is as near to it as their covariances allow. Right ones agree with the probability
/// `p_agree`. Where either has no scale, rotations alone are compared. No length enters but through the covariances.
bool loops_agree(const KeyframeMap& map, const LoopClosure& first, const LoopClosure& second, double p_agree,
                 const OdometryStepNoise& odometry = {});

}  // namespace fabloop
