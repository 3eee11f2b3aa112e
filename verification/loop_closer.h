// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/fabmap/domain_check.h"
#include "frontend/fabmap/hypotheses.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/motion_model.h"
#include "frontend/fabmap/place_recognizer.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/features.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/progress.h"
#include "verification/neighbour.h"
#include "verification/verifier.h"
#include "verification/view.h"

namespace fabloop {

struct LoopCloserOptions {
  WordFinderOptions words;
  PlaceRecognizerOptions recognizer;
  MotionModel motion;
  HypothesesOptions hypotheses;
  VerifierOptions verifier;
  NeighbourOptions neighbour;
  /// So many earlier keyframes give this one's features a depth: those 1, 2, 4, ... back that show enough of the same. The
  /// further ones have more parallax, the nearer ones more in common.
  std::size_t num_neighbours = 3;
  /// How many keyframes back to look for them: more for slow or high-rate cameras.
  std::size_t max_neighbour_distance = 16;
  int num_threads = 0;  ///< Hypotheses of one keyframe are verified in parallel; the result does not depend on it.
  Warn warn{};          ///< Told when keyframes look unlike the images that the model was trained on; see DomainCheck.
};

/// One image as a host hands it over.
struct Keyframe {
  std::size_t frame = 0;  ///< The host's number for it; ascending.
  Features features;      ///< Extracted with the model's options.
  Pose odom_from_camera;
};

/// A place that the image may show, and what became of it.
struct HypothesisOutcome {
  std::size_t match = 0;  ///< Keyframe::frame of the place.
  double probability = 0;
  double log_likelihood = 0;
  Verification verification;
};

/// Seconds spent on one keyframe.
struct LoopCloserTimes {
  double words_s = 0;      ///< Descriptors to words.
  double recognise_s = 0;  ///< Posterior and ranking.
  double neighbour_s = 0;  ///< Link and triangulation.
  double verify_s = 0;     ///< All hypotheses.
};

/// Everything that one keyframe led to.
struct LoopEvent {
  std::size_t query = 0;
  double p_new = 1;                           ///< Probability that the place was never seen before, neighbours in time left out.
  std::vector<HypothesisOutcome> hypotheses;  ///< Most probable first; accepted ones have Verdict::Accepted.
  std::vector<NeighbourLink> neighbours;      ///< What the images say about the way from earlier keyframes, nearest first.
  LoopCloserTimes times;
};

/// The module that a SLAM system plugs in: keyframe in; ranked hypotheses, verdicts and accepted loops out. Keeps every
/// keyframe's features in memory. Not safe to call from several threads at once.
class LoopCloser {
 public:
  /// Throws InputError when the model is not valid.
  LoopCloser(const Camera& camera, const Model& model, const LoopCloserOptions& options = {});

  /// Throws InputError when the features are not those of the model.
  LoopEvent add_keyframe(Keyframe keyframe);

  const std::vector<View>& views() const { return views_; }

 private:
  std::vector<Hypothesis> recognise(const Observation& observation, LoopEvent& event);
  std::vector<NeighbourLink> link_to_earlier(View& view);
  void verify(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const;

  Camera camera_;
  LoopCloserOptions options_;
  DescriptorKind descriptor_kind_;
  DomainCheck domain_check_;
  PlaceRecognizer recognizer_;
  WordFinder words_;
  Verifier verifier_;
  std::optional<Belief> belief_;
  std::vector<View> views_;              ///< By place.
  std::vector<Pose> odom_from_cameras_;  ///< By place.
};

}  // namespace fabloop
