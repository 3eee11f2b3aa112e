// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "frontend/fabmap/domain_check.h"
#include "frontend/fabmap/hypotheses.h"

namespace fabloop {
namespace {

using Clock = std::chrono::steady_clock;

double log_odds(const Belief& belief, PlaceId place) {
  const double log_p = belief.log_p_place[place];
  constexpr double kHalf = 0.5;
  if (belief.p_place[place] < kHalf) return log_p - std::log1p(-belief.p_place[place]);
  // 1 - p would round to nothing, so the others are summed, from logarithms.
  double highest = belief.log_p_new;
  for (PlaceId i = 0; i < belief.log_p_place.size(); ++i) {
    if (i != place) highest = std::max(highest, belief.log_p_place[i]);
  }
  if (!std::isfinite(highest)) return std::numeric_limits<double>::infinity();
  double sum = std::exp(belief.log_p_new - highest);
  for (PlaceId i = 0; i < belief.log_p_place.size(); ++i) {
    if (i != place) sum += std::exp(belief.log_p_place[i] - highest);
  }
  return log_p - (highest + std::log(sum));
}

std::vector<PlaceMatch> matches_of(const Belief& belief, std::size_t max_matches) {
  HypothesesOptions options;
  options.max_hypotheses = max_matches;
  options.num_recent_excluded = 0;  // they are ruled out already
  std::vector<PlaceMatch> matches;
  for (const Hypothesis& hypothesis : ranked_hypotheses(belief, options)) {
    matches.push_back({hypothesis.place, hypothesis.probability, hypothesis.log_likelihood, log_odds(belief, hypothesis.place)});
  }
  return matches;
}

/// Calls `step` for each image in turn and keeps what is made of it.
template <typename Step>
void recognize_each(const Model& model, const std::vector<ObservedImage>& images, const RecognitionOptions& options,
                    Recognition& recognition, const Step& step) {
  DomainCheck domain_check(model, {.warn = options.warn});
  for (const ObservedImage& image : images) {
    domain_check.add(image.observation);
    const auto start = Clock::now();
    AppearanceStep recognized = step(image);
    const std::size_t num_places = recognized.belief.p_place.size();
    const std::size_t num_kept = num_places - std::min(options.num_recent_excluded, num_places);
    const Belief belief = without_recent_places(std::move(recognized.belief), options.num_recent_excluded);
    recognition.images.push_back({image.frame, image.time_ns, image.observation.words.size(), num_places, recognized.place,
                                  recognized.is_new, belief.p_new, matches_of(belief, options.max_matches),
                                  std::chrono::duration<double>(Clock::now() - start).count()});
    if (options.on_row) options.on_row({belief.p_place.data(), num_kept}, belief.log_likelihood);
    if (options.progress) options.progress("recognising", recognition.images.size(), images.size());
  }
}

AppearanceStep add_to_map(AppearanceSlam& slam, const ObservedImage& image, Recognition& recognition) {
  AppearanceStep step = slam.process(image.observation);
  if (step.is_new) {
    recognition.places.emplace_back();
    recognition.place_times_ns.push_back(image.time_ns);
  }
  recognition.places[step.place].push_back(image.frame);
  return step;
}

}  // namespace

Recognition recognize_sequence(const Model& model, const std::vector<ObservedImage>& images, const RecognitionOptions& options) {
  AppearanceSlam slam(model, options.slam);
  Recognition recognition;
  recognize_each(model, images, options, recognition,
                 [&](const ObservedImage& image) { return add_to_map(slam, image, recognition); });
  return recognition;
}

Recognition recognize_in_map(const Model& model, const std::vector<ObservedImage>& map, const std::vector<ObservedImage>& queries,
                             const RecognitionOptions& options) {
  AppearanceSlam slam(model, options.slam);
  Recognition recognition;
  for (std::size_t i = 0; i < map.size(); ++i) {
    add_to_map(slam, map[i], recognition);
    if (options.progress) options.progress("making the map", i + 1, map.size());
  }
  slam.forget_motion();
  recognize_each(model, queries, options, recognition,
                 [&](const ObservedImage& image) { return slam.localize(image.observation); });
  return recognition;
}

std::vector<ScoredQuery> scored_queries(const Recognition& recognition) {
  std::vector<ScoredQuery> queries;
  queries.reserve(recognition.images.size());
  for (const RecognizedImage& image : recognition.images) {
    ScoredQuery query{image.frame, image.num_places, {}};
    for (const PlaceMatch& match : image.matches) query.matches.push_back({match.place, match.log_odds});
    queries.push_back(std::move(query));
  }
  return queries;
}

}  // namespace fabloop
