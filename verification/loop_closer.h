// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "frontend/fabmap/domain_check.h"
#include "frontend/fabmap/hypotheses.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/motion_model.h"
#include "frontend/fabmap/place_graph.h"
#include "frontend/fabmap/place_recognizer.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/progress.h"
#include "verification/keyframe.h"
#include "verification/loop_event.h"
#include "verification/map/keyframe_map.h"
#include "verification/neighbour.h"
#include "verification/rig/window_scale.h"
#include "verification/temporal_consistency.h"
#include "verification/verifier.h"

namespace fabloop {

/// Which places the keyframe at position `current` of the map may show, the best first: another recogniser in FAB-MAP's place.
/// Places are earlier positions, each named once, a probability (of the place given the image) in [0, 1]; where none is known,
/// 0.5.
using ProposePlaces = std::function<std::vector<Hypothesis>(std::size_t current)>;

struct LoopCloserOptions {
  WordFinderOptions words;
  PlaceRecognizerOptions recognizer;
  MotionModel motion;
  HypothesesOptions hypotheses;  ///< With an earlier map, `max_hypotheses` of its places and as many of this session's.
  ProposePlaces propose{};       ///< None: FAB-MAP proposes. With it `hypotheses` says only what counts as recent in `p_new`.
  VerifierOptions verifier;
  NeighbourOptions neighbour;
  ConsistencyOptions consistency;  ///< Off by default: every proven loop is handed out at once.
  OdometryStepNoise odometry;      ///< Of steps whose keyframes have no covariance.
  Pose body_from_camera;           ///< Where the camera sits on the body whose odometry is given.
  /// Relative standard deviation of the points and depths that keyframes bring along. More for stereo of a short baseline.
  double point_sigma = 0.02;
  /// So many earlier keyframes give this one's features a depth: those 1, 2, 4, ... back that show enough of the same. The
  /// further ones have more parallax, the nearer ones more in common.
  std::size_t num_neighbours = 3;
  /// How many keyframes back to look for them: more for slow or high-rate cameras.
  std::size_t max_neighbour_distance = 16;
  /// A loop without a length gets the one that so many keyframes around either side tell, the latest ones around the query. For
  /// hosts without depth whose steps are too short for points. It costs the square of this many comparisons a loop. 0, 1: never.
  std::size_t window_size = 0;
  WindowOptions window;  ///< Matching, max_error_px and seed are the verifier's.
  int num_threads = 0;   ///< Hypotheses of one keyframe are verified in parallel; the result does not depend on it.
  Warn warn{};           ///< Told when keyframes look unlike the images that the model was trained on; see DomainCheck.
};

/// The module that a SLAM system plugs in: keyframe in; ranked hypotheses, verdicts and accepted loops out. Keeps every
/// keyframe's features in memory. Not safe to call from several threads at once; AsyncLoopCloser is.
class LoopCloser {
 public:
  /// With the map of earlier sessions (see read_keyframe_map()), keyframes are recognised among those too. Throws InputError when
  /// the model, the camera or an option is not valid, or when the map was made with another model.
  LoopCloser(const Camera& camera, const Model& model, const LoopCloserOptions& options = {}, KeyframeMap earlier = {});

  /// Throws InputError when the keyframe is inconsistent (see validate()), does not come after the one before, or has features
  /// that are not the model's. A refused keyframe changes nothing.
  LoopEvent add_keyframe(const Keyframe& keyframe);

  /// All keyframes so far, those of earlier sessions first. Their positions are FAB-MAP's places.
  const KeyframeMap& map() const { return map_; }

 private:
  MapKeyframe look_at(const Keyframe& keyframe, LoopCloserTimes& times) const;
  Belief recognise(const Observation& words, LoopCloserTimes& times) const;
  std::vector<Hypothesis> most_probable(const Belief& belief, LoopEvent& event) const;
  std::vector<Hypothesis> proposed() const;
  void remember(MapKeyframe keyframe, Belief belief);
  void link_to_earlier(LoopEvent& event);
  void verify(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const;
  void ask_windows_for_scale(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const;
  /// The cameras of the keyframes of one session around a position of the map, all of them before `end`; in the frame of the
  /// camera at that position, their steps refined.
  std::vector<WindowView> window_around(std::size_t position, std::size_t end) const;
  /// What the odometry says of the pose of the last keyframe's camera in that of an earlier one, where it says anything.
  std::optional<PosePrior> odometry_prior(std::size_t match) const;
  void hand_out_loops(LoopEvent& event);

  void add_place(const Observation& words, bool follows_last);

  std::size_t session() const { return map_.sessions.size() - 1; }
  std::size_t num_of_this_session() const { return map_.keyframes.size() - num_earlier_; }

  LoopCloserOptions options_;
  FeatureExtractor extractor_;
  DomainCheck domain_check_;
  PlaceRecognizer recognizer_;
  WordFinder words_;
  Verifier verifier_;
  TemporalConsistency consistency_;
  std::optional<Belief> belief_;  ///< After the last keyframe.
  KeyframeMap map_;               ///< Its keyframes are the recogniser's places.
  PlaceGraph ways_;               ///< Which places follow which, in each session.
  std::size_t num_earlier_ = 0;   ///< Keyframes of earlier sessions.
};

}  // namespace fabloop
