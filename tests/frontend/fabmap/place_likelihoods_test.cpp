// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_likelihoods.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "frontend/error.h"
#include "frontend/fabmap/place_recognizer.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using testing_support::random_tree;
using testing_support::TreeSampler;

constexpr double kEnginesAgree = 1e-9;
constexpr std::array kEngines = {LikelihoodEngine::Exact, LikelihoodEngine::Table, LikelihoodEngine::BailOut,
                                 LikelihoodEngine::InvertedIndex};

/// The same places in recognisers with different engines, the exact one first.
struct Engines {
  Engines(const ChowLiuTree& tree, const DetectorModel& detector, const std::vector<Observation>& background,
          NewPlaceModel new_place = NewPlaceModel::MeanField) {
    PlaceRecognizerOptions options;
    options.new_place = new_place;
    options.max_samples = 10;
    for (const auto engine : kEngines) {
      options.engine = engine;
      recognizers.emplace_back(tree, detector, background, options);
    }
  }
  void add_place(const Observation& observation) {
    for (PlaceRecognizer& recognizer : recognizers) recognizer.add_place(observation);
  }
  void add_visit(PlaceId place, const Observation& observation) {
    for (PlaceRecognizer& recognizer : recognizers) recognizer.add_visit(place, observation);
  }
  void expect_to_agree(const Observation& observation) const {
    const Belief expected = recognizers.front().recognize(observation);
    for (const PlaceRecognizer& recognizer : recognizers) {
      const Belief belief = recognizer.recognize(observation);
      EXPECT_NEAR(belief.log_likelihood_new, expected.log_likelihood_new, kEnginesAgree);
      std::size_t next_dropped = 0;
      for (PlaceId place = 0; place < expected.p_place.size(); ++place) {
        if (next_dropped < belief.bailed_out.size() && belief.bailed_out[next_dropped] == place) {
          ++next_dropped;
          EXPECT_GE(belief.log_likelihood[place], expected.log_likelihood[place] - kEnginesAgree);
          continue;
        }
        EXPECT_NEAR(belief.log_likelihood[place], expected.log_likelihood[place], kEnginesAgree);
      }
    }
  }

  std::vector<PlaceRecognizer> recognizers;
};

TEST(LikelihoodEngines, EnginesAgreeOnRandomTreesAndPlaces) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const ChowLiuTree tree = seed == 6 ? naive_bayes(random_tree(300, 0.1, 6)) : random_tree(50 * seed, 0.1, seed);
    TreeSampler sampler(tree, seed);
    const std::vector<Observation> background = sampler.draw(20);
    const DetectorModel detector = {0.39, seed % 2 == 0 ? 0.0 : 0.02};
    for (const NewPlaceModel new_place : {NewPlaceModel::MeanField, NewPlaceModel::Sampled}) {
      Engines engines(tree, detector, background, new_place);
      for (int i = 0; i < 30; ++i) {
        const Observation observation = sampler.draw();
        engines.expect_to_agree(observation);
        // Every third image is one more visit, of places visited once and of places visited more often.
        if (i % 3 == 2)
          engines.add_visit(static_cast<PlaceId>(i % 2), observation);
        else
          engines.add_place(observation);
      }
    }
  }
}

TEST(LikelihoodEngines, EnginesAgreeAfterManyVisits) {
  for (const double p_seen_if_absent : {0.0, 0.01}) {
    const ChowLiuTree tree = random_tree(120, 0.1, 12);
    TreeSampler sampler(tree, 12);
    Engines engines(tree, {0.6, p_seen_if_absent}, {});
    const std::vector<Observation> observations = sampler.draw(2);
    for (const Observation& observation : observations) engines.add_place(observation);
    // 1,500 visits are more than e^-650 can tell apart from never.
    for (int visit = 0; visit < 1500; ++visit) engines.add_visit(0, observations[static_cast<std::size_t>(visit) % 2]);
    for (const Observation& query : sampler.draw(5)) engines.expect_to_agree(query);
    engines.expect_to_agree(observations[0]);
  }
}

TEST(LikelihoodEngines, EnginesAgreeAcrossBlocksOfTheIndex) {
  const ChowLiuTree tree = random_tree(10, 0.2, 13);
  TreeSampler sampler(tree, 13);
  Engines engines(tree, {0.39, 0.01}, {});
  constexpr PlaceId kBlock = PostingBlock::kCapacity;
  const std::vector<Observation> observations = sampler.draw(64);
  for (std::size_t i = 0; i < kBlock + 300; ++i) engines.add_place(observations[i % 64]);
  // Places of the full block and of the open one, once and again.
  for (const PlaceId place : {0u, 77u, 77u, kBlock - 1, kBlock, kBlock + 200, kBlock + 200}) {
    engines.add_visit(place, sampler.draw());
  }
  engines.expect_to_agree(sampler.draw());
}

TEST(LikelihoodEngines, BailOutKeepsTheBestAndBoundsTheRest) {
  const ChowLiuTree tree = random_tree(2000, 0.05, 14);
  TreeSampler sampler(tree, 14);
  PlaceRecognizerOptions bailing_out;
  bailing_out.engine = LikelihoodEngine::BailOut;
  PlaceRecognizer exact(tree, {}), bail_out(tree, {}, {}, bailing_out);
  const std::vector<Observation> places = sampler.draw(300);
  for (const Observation& place : places) {
    exact.add_place(place);
    bail_out.add_place(place);
  }
  std::size_t num_dropped = 0;
  for (PlaceId place = 0; place < 40; ++place) {
    const Belief expected = exact.recognize(places[place]);
    const Belief belief = bail_out.recognize(places[place]);
    num_dropped += belief.bailed_out.size();
    EXPECT_NEAR(belief.p_place[place], expected.p_place[place], 1e-6);  // what BailOutOptions::negligible promises
    for (const PlaceId dropped : belief.bailed_out) EXPECT_GE(belief.log_likelihood[dropped], expected.log_likelihood[dropped]);
  }
  EXPECT_GT(num_dropped, 40u * 200u);  // or the engine would be pointless
}

TEST(LikelihoodEngines, HaveNames) {
  for (const auto engine :
       {LikelihoodEngine::Exact, LikelihoodEngine::Table, LikelihoodEngine::BailOut, LikelihoodEngine::InvertedIndex}) {
    EXPECT_EQ(likelihood_engine_from_string(to_string(engine)), engine);
  }
  for (const auto new_place : {NewPlaceModel::MeanField, NewPlaceModel::Sampled, NewPlaceModel::None}) {
    EXPECT_EQ(new_place_model_from_string(to_string(new_place)), new_place);
  }
  EXPECT_FALSE(likelihood_engine_from_string("other"));
  EXPECT_FALSE(new_place_model_from_string(""));
}

TEST(BailOut, FindsTheLagOfBennettsBound) {
  for (const double variance : {0.01, 1.0, 40.0}) {
    for (const double max_term : {0.1, 1.0, 5.0}) {
      for (const double p : {0.5, 1e-3, 1e-9}) {
        const double newton = bennett_lag(variance, max_term, std::log(p), BennettSolver::Newton);
        const double bisection = bennett_lag(variance, max_term, std::log(p), BennettSolver::Bisection);
        EXPECT_NEAR(newton, bisection, 1e-9 * bisection);  // both solve to 1e-12
        EXPECT_NEAR(log_bennett_bound(variance, max_term, newton), std::log(p), 1e-9 * -std::log(p));
      }
    }
  }
  EXPECT_EQ(bennett_lag(0.0, 0.0, -1.0, BennettSolver::Newton), 0.0);
}

TEST(BailOut, BennettsBoundHoldsForSumsOfTerms) {
  // 30 terms of plus or minus one, so that the variance is 30.
  std::mt19937_64 generator(15);
  constexpr int kNumSums = 20000;
  std::vector<int> count_above(12, 0);
  for (int i = 0; i < kNumSums; ++i) {
    const int sum = 2 * std::popcount(generator() & ((1u << 30) - 1)) - 30;
    for (int lag = 0; lag < 12; ++lag) count_above[static_cast<std::size_t>(lag)] += sum > lag;
  }
  for (int lag = 1; lag < 12; ++lag) {
    EXPECT_LE(std::log(count_above[static_cast<std::size_t>(lag)] / double{kNumSums}), log_bennett_bound(30.0, 1.0, lag));
  }
}

TEST(BailOut, RefusesOptionsThatMeanNothing) {
  PlaceRecognizerOptions options;
  options.bail_out.check_every = 0;
  EXPECT_THROW(PlaceRecognizer(random_tree(10, 0.2, 11), {}, {}, options), InputError);
  options.bail_out = {1.0, 1e-6};
  EXPECT_THROW(PlaceRecognizer(random_tree(10, 0.2, 11), {}, {}, options), InputError);
}

TEST(PlaceStore, GivesBackWhatItWasGiven) {
  const PlaceModel once = {1, {0, 1, 127, 128, 20000, 3000000000u}, {1, 1, 1, 1, 1, 1}};
  const PlaceModel often = {300, {7, 8, 100000}, {300, 1, 129}};
  const auto expect_equal = [](const PlaceModel& a, const PlaceModel& b) {
    EXPECT_EQ(a.visits, b.visits);
    EXPECT_EQ(a.words, b.words);
    EXPECT_EQ(a.detections, b.detections);
  };
  PlaceStore store;
  store.push_back(once);
  store.push_back({1, {}, {}});
  store.push_back(often);
  expect_equal(store[0], once);
  expect_equal(store[1], {1, {}, {}});
  expect_equal(store[2], often);
  store.set(1, often);
  expect_equal(store[1], often);
}

}  // namespace
}  // namespace fabloop
