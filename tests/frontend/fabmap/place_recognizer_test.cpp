// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_recognizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "frontend/error.h"
#include "frontend/parallel.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using testing_support::random_tree;
using testing_support::TreeSampler;

constexpr double kPosteriorSumsToOne = 1e-12;

double sum(const Belief& belief) { return std::accumulate(belief.p_place.begin(), belief.p_place.end(), belief.p_new); }

TEST(PlaceRecognizer, BeliefSumsToOne) {
  const ChowLiuTree tree = random_tree(500, 0.05, 7);
  TreeSampler sampler(tree, 7);
  PlaceRecognizer recognizer(tree, {});
  for (int i = 0; i < 300; ++i) {
    const Observation observation = sampler.draw();
    EXPECT_NEAR(sum(recognizer.recognize(observation)), 1.0, kPosteriorSumsToOne);
    recognizer.add_place(observation);
  }
}

TEST(PlaceRecognizer, KnowsPlacesAgainAndNewPlacesAsNew) {
  const ChowLiuTree tree = random_tree(1000, 0.05, 8);
  TreeSampler sampler(tree, 8);
  PlaceRecognizer recognizer(tree, {0.8, 0.0});
  const std::vector<Observation> places = sampler.draw(50);
  for (const Observation& place : places) recognizer.add_place(place);
  for (PlaceId place = 0; place < 50; ++place) {
    Observation again = places[place];
    for (std::size_t i = 0; i < again.words.size(); i += 4)
      again.words.erase(again.words.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_GT(recognizer.recognize(again).p_place[place], 0.99);
  }
  EXPECT_GT(recognizer.recognize(sampler.draw()).p_new, 0.5);
}

TEST(PlaceRecognizer, ListensToThePrior) {
  const ChowLiuTree tree = random_tree(100, 0.1, 9);
  TreeSampler sampler(tree, 9);
  PlaceRecognizer recognizer(tree, {});
  const Observation observation = sampler.draw();
  recognizer.add_place(observation);
  recognizer.add_place(observation);
  const Belief even = recognizer.recognize(observation);
  EXPECT_DOUBLE_EQ(even.p_place[0], even.p_place[1]);
  const Belief biased = recognizer.recognize(observation, {0.1, {0.6, 0.3}});
  EXPECT_NEAR(biased.p_place[0], 2.0 * biased.p_place[1], kPosteriorSumsToOne);
  const Belief excluded = recognizer.recognize(observation, without_recent_places(uniform_prior(2), 1));
  EXPECT_EQ(excluded.p_place[1], 0.0);
  EXPECT_NEAR(sum(excluded), 1.0, kPosteriorSumsToOne);
  EXPECT_THROW(recognizer.recognize(observation, uniform_prior(3)), InputError);
}

TEST(PlaceRecognizer, StaysFiniteWhereProbabilitiesUnderflow) {
  const Belief belief = posterior(uniform_prior(3), {-1.0, -5000.0, -6000.0}, -7000.0);
  EXPECT_EQ(belief.p_place[1], 0.0);
  EXPECT_NEAR(belief.log_p_place[1] - belief.log_p_place[2], 1000.0, kPosteriorSumsToOne);
  EXPECT_NEAR(sum(belief), 1.0, kPosteriorSumsToOne);
}

TEST(PlaceRecognizer, TakesImagesWithoutWordsAndVocabulariesOfOneWord) {
  const ChowLiuTree one_word = {{{std::nullopt, 0.2, 0.2, 0.2}}};
  PlaceRecognizer recognizer(one_word, {});
  EXPECT_EQ(recognizer.recognize({}).p_new, 1.0);
  recognizer.add_place({});
  recognizer.add_place({{0}});
  const Belief belief = recognizer.recognize({{0}});
  EXPECT_GT(belief.p_place[1], belief.p_place[0]);
  EXPECT_NEAR(sum(belief), 1.0, kPosteriorSumsToOne);
  EXPECT_NEAR(sum(recognizer.recognize({})), 1.0, kPosteriorSumsToOne);
}

TEST(PlaceRecognizer, AnswersQueriesInParallel) {
  const ChowLiuTree tree = random_tree(300, 0.1, 10);
  TreeSampler sampler(tree, 10);
  PlaceRecognizer recognizer(tree, {});
  for (const Observation& place : sampler.draw(100)) recognizer.add_place(place);
  const std::vector<Observation> queries = sampler.draw(64);
  std::vector<Belief> beliefs(queries.size());
  parallel_for(queries.size(), 4, [&](std::size_t i) { beliefs[i] = recognizer.recognize(queries[i]); });
  for (std::size_t i = 0; i < queries.size(); ++i) EXPECT_EQ(beliefs[i].p_place, recognizer.recognize(queries[i]).p_place);
}

TEST(PlaceRecognizer, RefusesWhatItCannotUse) {
  const ChowLiuTree tree = random_tree(10, 0.2, 11);
  EXPECT_THROW(PlaceRecognizer(ChowLiuTree{}, {}), InputError);
  EXPECT_THROW(PlaceRecognizer(tree, {1.5, 0.0}), InputError);
  PlaceRecognizerOptions sampled;
  sampled.new_place = NewPlaceModel::Sampled;
  EXPECT_THROW(PlaceRecognizer(tree, {}, {}, sampled), InputError);
  PlaceRecognizer recognizer(tree, {});
  EXPECT_THROW(recognizer.recognize({{10}}), InputError);
  EXPECT_THROW(recognizer.add_place({{3, 2}}), InputError);
  EXPECT_EQ(recognizer.num_places(), 0u);
}

TEST(PlaceRecognizer, WithoutANewPlaceSpreadsAllBeliefOverThePlaces) {
  const ChowLiuTree tree = random_tree(100, 0.1, 16);
  TreeSampler sampler(tree, 16);
  PlaceRecognizerOptions options;
  options.new_place = NewPlaceModel::None;
  PlaceRecognizer recognizer(tree, {}, {}, options);
  EXPECT_EQ(recognizer.recognize({}).p_new, 1.0);  // there is nowhere else
  for (const Observation& place : sampler.draw(5)) recognizer.add_place(place);
  const Belief belief = recognizer.recognize(sampler.draw());
  EXPECT_EQ(belief.p_new, 0.0);
  EXPECT_NEAR(sum(belief), 1.0, kPosteriorSumsToOne);
}

TEST(PlaceModel, CountsVisitsAndDetections) {
  PlaceModel place;
  add_visit(place, {{1, 5}});
  add_visit(place, {{0, 5, 9}});
  add_visit(place, {});
  EXPECT_EQ(place.visits, 3u);
  EXPECT_EQ(place.words, (std::vector<WordId>{0, 1, 5, 9}));
  EXPECT_EQ(place.detections, (std::vector<std::uint32_t>{1, 1, 2, 1}));
}

}  // namespace
}  // namespace fabloop
