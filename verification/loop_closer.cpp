// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_closer.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Adds the time until its end to a figure.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

LoopCloser::LoopCloser(const Camera& camera, const Model& model, const LoopCloserOptions& options)
    : camera_(camera),
      options_(options),
      descriptor_kind_(model.features.kind.descriptor),
      domain_check_(model, {.warn = options.warn}),
      recognizer_(model, options.recognizer),
      words_(model.vocabulary, options.words),
      verifier_(options.verifier) {}

LoopEvent LoopCloser::add_keyframe(Keyframe keyframe) {
  if (keyframe.features.descriptor_kind != descriptor_kind_) {
    throw InputError("the model knows " + std::string(to_string(descriptor_kind_)) + " descriptors, the keyframe has " +
                     std::string(to_string(keyframe.features.descriptor_kind)) + "; extract with the model's options");
  }
  LoopEvent event;
  event.query = keyframe.frame;
  Observation observation;
  {
    const Stopwatch watch(event.times.words_s);
    observation = words_.observe(keyframe.features.descriptors);
  }
  domain_check_.add(observation);
  const std::vector<Hypothesis> hypotheses = recognise(observation, event);
  views_.push_back(make_view(keyframe.frame, camera_, std::move(keyframe.features)));
  odom_from_cameras_.push_back(keyframe.odom_from_camera);
  {
    const Stopwatch watch(event.times.neighbour_s);
    event.neighbours = link_to_earlier(views_.back());
  }
  verify(hypotheses, event);
  return event;
}

std::vector<Hypothesis> LoopCloser::recognise(const Observation& observation, LoopEvent& event) {
  const Stopwatch watch(event.times.recognise_s);
  const std::size_t num_places = recognizer_.num_places();
  const Prior prior = belief_ ? predict(options_.motion, *belief_, num_places) : uniform_prior(num_places);
  belief_ = recognizer_.recognize(observation, prior);
  recognizer_.add_place(observation);
  const auto all = ranked_hypotheses(*belief_, {num_places, options_.hypotheses.num_recent_excluded, 0.0});
  std::vector<Hypothesis> best;
  double p_known = 0;
  for (const Hypothesis& hypothesis : all) {
    p_known += hypothesis.probability;
    if (best.size() < options_.hypotheses.max_hypotheses && hypothesis.probability >= options_.hypotheses.min_probability) {
      best.push_back(hypothesis);
    }
  }
  event.p_new = std::max(0.0, 1.0 - p_known);
  return best;
}

std::vector<NeighbourLink> LoopCloser::link_to_earlier(View& view) {
  const std::size_t current = views_.size() - 1;
  std::vector<NeighbourLink> links;
  for (std::size_t distance = 1; distance <= options_.max_neighbour_distance && distance <= current; distance *= 2) {
    if (links.size() == options_.num_neighbours) break;
    const std::size_t earlier = current - distance;
    NeighbourOptions options = options_.neighbour;
    options.seed = pair_seed(options_.verifier.seed, view.frame, views_[earlier].frame);
    const Pose earlier_from_current = odom_from_cameras_[earlier].inverse() * odom_from_cameras_[current];
    const auto link = link_neighbours(views_[earlier], view, earlier_from_current, options);
    if (link) links.push_back(*link);
  }
  return links;
}

void LoopCloser::verify(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const {
  const Stopwatch watch(event.times.verify_s);
  event.hypotheses.resize(hypotheses.size());
  parallel_for(hypotheses.size(), options_.num_threads, [&](std::size_t i) {
    const View& match = views_[hypotheses[i].place];
    event.hypotheses[i] = {match.frame, hypotheses[i].probability, hypotheses[i].log_likelihood,
                           verifier_.verify(views_.back(), match)};
  });
}

}  // namespace fabloop
