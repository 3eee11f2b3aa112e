// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_closer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model_hash.h"
#include "frontend/parallel.h"
#include "frontend/stopwatch.h"

namespace fabloop {
namespace {

void validate(const LoopCloserOptions& options) {
  predict(options.motion, Belief{}, 0);  // throws for numbers that are no probabilities
  if (!(options.point_sigma > 0.0)) throw InputError("point_sigma must be positive: the points' error as a share of their depth");
  const Pose& pose = options.body_from_camera;
  constexpr double kMaxQuaternionNormError = 1e-3;
  if (!pose.translation.allFinite() || !(std::abs(pose.rotation.norm() - 1.0) < kMaxQuaternionNormError)) {
    throw InputError("body_from_camera is no pose: its translation must be finite and its quaternion of unit length");
  }
}

NeighbourOptions neighbour_options(const LoopCloserOptions& options) {
  NeighbourOptions neighbour = options.neighbour;
  neighbour.seed = options.verifier.seed;
  return neighbour;
}

void require_model(const KeyframeMap& earlier, const Model& model) {
  if (earlier.keyframes.empty() || earlier.model_hash == model_hash(model)) return;
  throw InputError(
      "the earlier map was made with another model, whose words mean something else; give the model that it was made with, or "
      "map "
      "again");
}

}  // namespace

LoopCloser::LoopCloser(const Camera& camera, const Model& model, const LoopCloserOptions& options, KeyframeMap earlier)
    : options_(options),
      extractor_(model.features),
      domain_check_(model, {.warn = options.warn}),
      recognizer_(model, options.recognizer),
      words_(model.vocabulary, options.words),
      verifier_(options.verifier),
      consistency_(options.consistency, options.odometry) {
  fabloop::validate(camera, "the loop closer's camera");
  validate(options);
  map_ = std::move(earlier);
  require_model(map_, model);
  map_.model_hash = model_hash(model);
  for (std::size_t i = 0; i < map_.keyframes.size(); ++i) {
    add_place(map_.keyframes[i].words, i > 0 && map_.keyframes[i].session == map_.keyframes[i - 1].session);
    if (options.verifier.match_by == MatchBy::Words) {
      View& view = map_.keyframes[i].view;
      view.words = words_.nearest_words(view.features.descriptors);  // map files do not keep them
    }
  }
  num_earlier_ = map_.keyframes.size();
  map_.sessions.push_back({camera, options.body_from_camera});
}

LoopEvent LoopCloser::add_keyframe(const Keyframe& keyframe) {
  fabloop::validate(keyframe, map_.sessions.back().camera, extractor_.options().kind.descriptor);
  if (num_of_this_session() > 0) require_follows(keyframe, map_.keyframes.back().view.frame, map_.keyframes.back().time_ns);
  LoopEvent event;
  event.query = keyframe.frame;
  event.time_ns = keyframe.time_ns;
  event.session = session();
  MapKeyframe seen = look_at(keyframe, event.times);
  Belief belief = recognise(seen.words, event.times);
  // Whatever can be refused was refused by now, and nothing has changed yet.
  const std::vector<Hypothesis> best = most_probable(belief, event);
  const std::vector<Hypothesis> hypotheses = options_.propose ? proposed() : best;
  remember(std::move(seen), std::move(belief));
  link_to_earlier(event);
  verify(hypotheses, event);
  hand_out_loops(event);
  return event;
}

MapKeyframe LoopCloser::look_at(const Keyframe& keyframe, LoopCloserTimes& times) const {
  Features features;
  if (keyframe.features) {
    features = *keyframe.features;
    features.descriptors = features.descriptors.clone();  // hosts reuse their buffers
  } else {
    const Stopwatch watch(times.features_s);
    features = extractor_.extract(keyframe.image);
  }
  MapKeyframe seen;
  seen.session = session();
  seen.time_ns = keyframe.time_ns;
  seen.odom_from_body = {keyframe.odom_from_body.rotation.normalized(), keyframe.odom_from_body.translation};
  seen.step_covariance = keyframe.step_covariance;
  const Stopwatch watch(times.words_s);
  std::vector<WordId> words = words_.nearest_words(features.descriptors);
  seen.words = observation_of(words);
  seen.view = view_of(keyframe, map_.sessions.back().camera, std::move(features), options_.point_sigma);
  if (options_.verifier.match_by == MatchBy::Words) seen.view.words = std::move(words);
  return seen;
}

Belief LoopCloser::recognise(const Observation& words, LoopCloserTimes& times) const {
  const Stopwatch watch(times.recognise_s);
  return recognizer_.recognize(words,
                               belief_ ? predict(options_.motion, *belief_, ways_) : uniform_prior(recognizer_.num_places()));
}

std::vector<Hypothesis> LoopCloser::most_probable(const Belief& belief, LoopEvent& event) const {
  const Stopwatch watch(event.times.recognise_s);
  const std::size_t num_recent = std::min(options_.hypotheses.num_recent_excluded, num_of_this_session());
  const auto all = ranked_hypotheses(belief, {belief.p_place.size(), num_recent, 0.0});
  std::vector<Hypothesis> best;
  std::size_t num_earlier = 0, num_own = 0;
  double p_known = 0;
  for (const Hypothesis& hypothesis : all) {
    p_known += hypothesis.probability;
    std::size_t& num_chosen = hypothesis.place < num_earlier_ ? num_earlier : num_own;
    if (num_chosen == options_.hypotheses.max_hypotheses || hypothesis.probability < options_.hypotheses.min_probability)
      continue;
    best.push_back(hypothesis);
    ++num_chosen;
  }
  event.p_new = std::max(0.0, 1.0 - p_known);
  return best;
}

std::vector<Hypothesis> LoopCloser::proposed() const {
  std::vector<Hypothesis> hypotheses = options_.propose(map_.keyframes.size());
  std::set<PlaceId> named;
  for (const Hypothesis& hypothesis : hypotheses) {
    if (hypothesis.place >= map_.keyframes.size() || !(hypothesis.probability >= 0.0 && hypothesis.probability <= 1.0)) {
      throw InputError("a proposed place is no earlier keyframe, or its probability is none: place " +
                       std::to_string(hypothesis.place) + " for the keyframe at position " +
                       std::to_string(map_.keyframes.size()));
    }
    if (!named.insert(hypothesis.place).second) {
      throw InputError("a place is proposed twice, and its loop would count twice: place " + std::to_string(hypothesis.place) +
                       " for the keyframe at position " + std::to_string(map_.keyframes.size()) + "; propose each place once");
    }
  }
  return hypotheses;
}

void LoopCloser::remember(MapKeyframe keyframe, Belief belief) {
  domain_check_.add(keyframe.words);
  add_place(keyframe.words, num_of_this_session() > 0);
  belief_ = std::move(belief);
  map_.keyframes.push_back(std::move(keyframe));
}

void LoopCloser::add_place(const Observation& words, bool follows_last) {
  const PlaceId place = recognizer_.add_place(words);
  ways_.next.resize(recognizer_.num_places());
  if (follows_last) link(ways_, place - 1, place);
}

void LoopCloser::link_to_earlier(LoopEvent& event) {
  const Stopwatch watch(event.times.neighbour_s);
  const std::size_t current = map_.keyframes.size() - 1;
  MapKeyframe& now = map_.keyframes[current];
  const Pose odom_from_camera = now.odom_from_body * options_.body_from_camera;
  std::vector<RecentView> recent;
  std::vector<std::size_t> keyframes;
  for (std::size_t distance = 1; distance <= options_.max_neighbour_distance && distance < num_of_this_session(); distance *= 2) {
    const MapKeyframe& earlier = map_.keyframes[current - distance];
    recent.push_back({&earlier.view, (earlier.odom_from_body * options_.body_from_camera).inverse() * odom_from_camera,
                      relative_distance_sigma(odometry_between(map_, current - distance, current, options_.odometry))});
    keyframes.push_back(current - distance);
  }
  const NeighbourOptions options = neighbour_options(options_);
  event.changed.push_back(current);
  for (const RecentNeighbour& neighbour : see_recent(recent, now.view, options_.num_neighbours, options, options_.num_threads)) {
    const std::size_t earlier = keyframes[neighbour.recent];
    give_depths(map_.keyframes[earlier].view, now.view, neighbour);
    event.neighbours.push_back(neighbour.seen.link);
    event.changed.push_back(earlier);
  }
}

void LoopCloser::verify(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const {
  const Stopwatch watch(event.times.verify_s);
  event.hypotheses.resize(hypotheses.size());
  parallel_for(hypotheses.size(), options_.num_threads, [&](std::size_t i) {
    const MapKeyframe& match = map_.keyframes[hypotheses[i].place];
    event.hypotheses[i] = {match.view.frame, match.session, hypotheses[i].probability, hypotheses[i].log_likelihood,
                           verifier_.verify(map_.keyframes.back().view, match.view,
                                            {odometry_prior(hypotheses[i].place), hypotheses[i].probability})};
  });
  if (options_.window_size > 1) ask_windows_for_scale(hypotheses, event);
}

void LoopCloser::ask_windows_for_scale(const std::vector<Hypothesis>& hypotheses, LoopEvent& event) const {
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Verification& found = event.hypotheses[i].verification;
    if (found.verdict == Verdict::Accepted && !found.has_scale) asked.push_back(i);
  }
  if (asked.empty()) return;
  const std::vector<WindowView> query = window_around(map_.keyframes.size() - 1, map_.keyframes.size());
  const std::size_t query_begin = map_.keyframes.size() - query.size();
  WindowOptions options = options_.window;
  options.matching = options_.verifier.matching;
  options.max_error_px = options_.verifier.max_error_px;
  options.seed = options_.verifier.seed;
  parallel_for(asked.size(), options_.num_threads, [&](std::size_t i) {
    const Hypothesis& hypothesis = hypotheses[asked[i]];
    if (hypothesis.place >= query_begin) return;  // views of both windows would prove themselves
    Verification& found = event.hypotheses[asked[i]].verification;
    auto scaled = scale_by_windows(found, query, window_around(hypothesis.place, query_begin), options, options_.verifier);
    if (!scaled) return;
    scaled->p_true = loop_probability(*scaled, {odometry_prior(hypothesis.place), hypothesis.probability});
    if (scaled->p_true >= options_.verifier.min_probability) found = *std::move(scaled);
  });
}

std::vector<WindowView> LoopCloser::window_around(std::size_t position, std::size_t end) const {
  const std::size_t session = map_.keyframes[position].session;
  const auto is_of_session = [&](std::size_t i) { return map_.keyframes[i].session == session; };
  std::size_t begin = position, last = position;
  for (std::size_t i = 0; i < options_.window_size / 2 && last + 1 < end && is_of_session(last + 1); ++i) ++last;
  while (begin > 0 && last - begin + 1 < options_.window_size && is_of_session(begin - 1)) --begin;
  const Pose& body_from_camera = map_.sessions[session].body_from_camera;
  const Pose window_from_odom = (map_.keyframes[position].odom_from_body * body_from_camera).inverse();
  std::vector<WindowView> window;
  for (std::size_t i = begin; i <= last; ++i) {
    window.push_back({&map_.keyframes[i].view, window_from_odom * map_.keyframes[i].odom_from_body * body_from_camera});
  }
  const NeighbourOptions options = neighbour_options(options_);
  return refine_window(window, position - begin, options).views;
}

std::optional<PosePrior> LoopCloser::odometry_prior(std::size_t match) const {
  if (match < num_earlier_) return std::nullopt;
  const UncertainPose body_from_camera{options_.body_from_camera};
  const UncertainPose match_body_from_query_body = odometry_between(map_, match, map_.keyframes.size() - 1, options_.odometry);
  const UncertainPose match_from_query = inverse(body_from_camera) * match_body_from_query_body * body_from_camera;
  // A body that stood still, or a host that is certain of an axis, leaves the prior without an inverse.
  if (match_from_query.covariance.llt().info() != Eigen::Success) return std::nullopt;
  return PosePrior{match_from_query.pose, match_from_query.covariance};
}

void LoopCloser::hand_out_loops(LoopEvent& event) {
  std::vector<LoopClosure> proven;
  for (const HypothesisOutcome& outcome : event.hypotheses) {
    if (outcome.verification.verdict != Verdict::Accepted) continue;
    const Pose& match_body_from_camera = map_.sessions[outcome.match_session].body_from_camera;
    proven.push_back(loop_closure(event.query, outcome, options_.body_from_camera, match_body_from_camera));
  }
  ConfirmedLoops confirmed = consistency_.add(map_, proven);
  event.loops = std::move(confirmed.now);
  event.confirmed = std::move(confirmed.earlier);
  for (HypothesisOutcome& outcome : event.hypotheses) {
    const bool is_handed_out = std::any_of(event.loops.begin(), event.loops.end(), [&](const LoopClosure& loop) {
      return loop.match == outcome.match && loop.match_session == outcome.match_session;
    });
    if (outcome.verification.verdict == Verdict::Accepted && !is_handed_out) outcome.verification.verdict = Verdict::Unconfirmed;
  }
}

}  // namespace fabloop
