// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/appearance_slam.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/names.h"

namespace fabloop {
namespace {

constexpr std::array<Named<Revisit>, 3> kNames{
    {{Revisit::Never, "never"}, {Revisit::MostProbable, "most-probable"}, {Revisit::AboveThreshold, "threshold"}}};

/// By log probability, since probabilities underflow; the first among equals.
PlaceId most_probable(const Belief& belief) {
  const auto best = std::max_element(belief.log_p_place.begin(), belief.log_p_place.end());
  return static_cast<PlaceId>(best - belief.log_p_place.begin());
}

}  // namespace

AppearanceSlam::AppearanceSlam(PlaceRecognizer recognizer, const AppearanceSlamOptions& options)
    : recognizer_(std::move(recognizer)), options_(options), graph_(route(recognizer_.num_places())) {
  if (!(options.min_revisit_probability > 0.0 && options.min_revisit_probability <= 1.0)) {
    throw InputError("the least probability of a revisit is " + std::to_string(options.min_revisit_probability) +
                     "; give more than 0 and at most 1");
  }
}

AppearanceSlam::AppearanceSlam(const Model& model, const AppearanceSlamOptions& options)
    : AppearanceSlam(PlaceRecognizer(model, options.recognizer), options) {}

AppearanceStep AppearanceSlam::process(const Observation& observation) {
  AppearanceStep step{believe(observation)};
  const bool is_first = recognizer_.num_places() == 0;
  if (!is_first) step.place = most_probable(step.belief);
  step.is_new = is_first || !is_revisit(step.belief, step.place);
  if (step.is_new) {
    step.place = recognizer_.add_place(observation);
    graph_.next.resize(recognizer_.num_places());
  } else {
    recognizer_.add_visit(step.place, observation);
  }
  if (last_place_) link(graph_, *last_place_, step.place);
  last_place_ = step.place;
  return step;
}

AppearanceStep AppearanceSlam::localize(const Observation& observation) {
  if (recognizer_.num_places() == 0) throw InputError("there is no place in the map to localise in; add images to it first");
  AppearanceStep step{believe(observation)};
  step.place = most_probable(step.belief);
  step.is_new = step.belief.log_p_new > step.belief.log_p_place[step.place];
  return step;
}

void AppearanceSlam::forget_motion() {
  last_belief_.reset();
  last_place_.reset();
}

Belief AppearanceSlam::believe(const Observation& observation) {
  const Prior prior = last_belief_ ? predict(options_.motion, *last_belief_, graph_)
                                   : uniform_prior(recognizer_.num_places(), options_.motion.p_new);
  Belief belief = smoothed(recognizer_.recognize(observation, prior), options_.trust);
  last_belief_ = belief;
  return belief;
}

bool AppearanceSlam::is_revisit(const Belief& belief, PlaceId best) const {
  switch (options_.revisit) {
    case Revisit::MostProbable:
      return belief.log_p_place[best] >= belief.log_p_new;
    case Revisit::AboveThreshold:
      return belief.p_place[best] >= options_.min_revisit_probability;
    case Revisit::Never:
      break;
  }
  return false;
}

std::string_view to_string(Revisit revisit) { return name_of(kNames, revisit); }

std::optional<Revisit> revisit_from_string(std::string_view name) { return named(kNames, name); }

}  // namespace fabloop
