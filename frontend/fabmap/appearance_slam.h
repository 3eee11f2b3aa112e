// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/motion_model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/place_graph.h"
#include "frontend/fabmap/place_recognizer.h"

namespace fabloop {

/// What becomes of an image that may show a known place.
enum class Revisit {
  Never,           ///< Every image is a place of its own. For cameras whose images lie apart, and for loop closure.
  MostProbable,    ///< It joins the most probable place, unless a new place is more probable still.
  AboveThreshold,  ///< It joins the most probable place where that is at least `min_revisit_probability`.
};

struct AppearanceSlamOptions {
  PlaceRecognizerOptions recognizer;
  MotionModel motion;
  /// Joining makes places of video at any rate, refines each by all its visits, and keeps the map from growing where the
  /// camera stays.
  Revisit revisit = Revisit::Never;
  double min_revisit_probability = 0.9;  ///< Only for `AboveThreshold`. Higher keeps places purer and makes more of them.
  double trust = 1.0;  ///< Of each belief, see smoothed(). Less where one wrong image must not make the next ones certain.
};

/// What one image led to.
struct AppearanceStep {
  Belief belief;       ///< Over the places there were before this image.
  PlaceId place = 0;   ///< Where the image was put: a place that was there before, or the new last one.
  bool is_new = true;  ///< Whether that place is new. With localize(): whether it is more probably at none of the places.
};

/// Appearance-only SLAM (Cummins & Newman 2008): each image is recognised among the places seen so far, then becomes a new
/// place or one more visit of a known one; how the camera got from place to place makes the graph that predicts the next.
class AppearanceSlam {
 public:
  /// Throws as PlaceRecognizer does.
  explicit AppearanceSlam(PlaceRecognizer recognizer, const AppearanceSlamOptions& options = {});
  explicit AppearanceSlam(const Model& model, const AppearanceSlamOptions& options = {});

  /// Recognises one image, in order of time, and puts it into the map.
  AppearanceStep process(const Observation& observation);

  /// Recognises one image in a map that stays as it is. `place` is then the most probable one. Needs at least one place.
  AppearanceStep localize(const Observation& observation);

  /// Forgets where the camera was: the next image may be anywhere. Between sequences.
  void forget_motion();

  const PlaceRecognizer& recognizer() const { return recognizer_; }
  const PlaceGraph& graph() const { return graph_; }

 private:
  Belief believe(const Observation& observation);
  bool is_revisit(const Belief& belief, PlaceId best) const;

  PlaceRecognizer recognizer_;
  AppearanceSlamOptions options_;
  PlaceGraph graph_;                   ///< The camera's ways from place to place.
  std::optional<Belief> last_belief_;  ///< After the last image, over the places there are now.
  std::optional<PlaceId> last_place_;
};

/// "never", "most-probable", "threshold": the names used in options and files.
std::string_view to_string(Revisit revisit);
std::optional<Revisit> revisit_from_string(std::string_view name);

}  // namespace fabloop
