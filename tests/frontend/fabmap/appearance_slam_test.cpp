// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/appearance_slam.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "frontend/error.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using testing_support::random_tree;
using testing_support::TreeSampler;

constexpr double kSumsToOne = 1e-12;

/// What a camera sees of a place: each of its words with probability 0.8.
Observation seen_again(const Observation& place, std::mt19937_64& generator) {
  Observation seen;
  for (const WordId word : place.words) {
    if (generator() % 10 < 8) seen.words.push_back(word);
  }
  return seen;
}

/// A world of places, a detector as good as the camera, and a map that starts empty.
struct World {
  explicit World(const AppearanceSlamOptions& options, std::size_t num_places = 20)
      : tree(random_tree(600, 0.06, 3)),
        places(TreeSampler(tree, 3).draw(num_places)),
        slam(PlaceRecognizer(tree, {0.8, 0.001}, {}, options.recognizer), options) {}

  AppearanceStep visit(std::size_t place) { return slam.process(seen_again(places[place], generator)); }

  ChowLiuTree tree;
  std::vector<Observation> places;
  AppearanceSlam slam;
  std::mt19937_64 generator{5};
};

TEST(AppearanceSlam, MakesEveryImageAPlaceWhenNothingIsRevisited) {
  World world({});
  for (std::size_t i = 0; i < 30; ++i) {
    const AppearanceStep step = world.visit(i % 20);
    EXPECT_TRUE(step.is_new);
    EXPECT_EQ(step.place, i);
    EXPECT_EQ(step.belief.p_place.size(), i);
  }
  EXPECT_EQ(world.slam.recognizer().num_places(), 30u);
}

TEST(AppearanceSlam, JoinsVisitsToOnePlaceEach) {
  for (const Revisit revisit : {Revisit::MostProbable, Revisit::AboveThreshold}) {
    AppearanceSlamOptions options;
    options.revisit = revisit;
    World world(options);
    for (int round = 0; round < 4; ++round) {
      for (std::size_t place = 0; place < 20; ++place) {
        // A camera at a high rate: three images of each place in a row.
        for (int i = 0; i < 3; ++i) {
          const AppearanceStep step = world.visit(place);
          EXPECT_EQ(step.place, place);
          EXPECT_EQ(step.is_new, round == 0 && i == 0);
          EXPECT_NEAR(std::accumulate(step.belief.p_place.begin(), step.belief.p_place.end(), step.belief.p_new), 1.0,
                      kSumsToOne);
        }
      }
    }
    EXPECT_EQ(world.slam.recognizer().num_places(), 20u);
  }
}

TEST(AppearanceSlam, LinksPlacesAsTheCameraWentThroughThem) {
  AppearanceSlamOptions options;
  options.revisit = Revisit::MostProbable;
  World world(options);
  for (const std::size_t place : {0, 1, 2, 0, 3, 2, 0}) world.visit(place);
  const PlaceGraph& graph = world.slam.graph();
  ASSERT_EQ(graph.num_places(), 4u);
  EXPECT_EQ(graph.next[0], (std::vector<PlaceId>{1, 3}));
  EXPECT_EQ(graph.next[1], (std::vector<PlaceId>{2}));
  EXPECT_EQ(graph.next[2], (std::vector<PlaceId>{0}));
  EXPECT_EQ(graph.next[3], (std::vector<PlaceId>{2}));
}

TEST(AppearanceSlam, LocalisesWithoutChangingTheMap) {
  AppearanceSlamOptions options;
  options.recognizer.new_place = NewPlaceModel::None;
  World world(options);
  EXPECT_THROW(world.slam.localize({}), InputError);
  for (std::size_t place = 0; place < 20; ++place) world.visit(place);
  world.slam.forget_motion();
  for (std::size_t i = 0; i < 40; ++i) {
    const AppearanceStep step = world.slam.localize(seen_again(world.places[i % 20], world.generator));
    EXPECT_EQ(step.place, i % 20);
    EXPECT_FALSE(step.is_new);
    EXPECT_EQ(step.belief.p_new, 0.0);
    EXPECT_NEAR(std::accumulate(step.belief.p_place.begin(), step.belief.p_place.end(), 0.0), 1.0, kSumsToOne);
  }
  EXPECT_EQ(world.slam.recognizer().num_places(), 20u);
}

TEST(AppearanceSlam, SaysWhereItIsNotAtAnyPlace) {
  World world({}, 10);
  for (std::size_t place = 0; place < 5; ++place) world.visit(place);
  world.slam.forget_motion();
  EXPECT_FALSE(world.slam.localize(world.places[2]).is_new);
  EXPECT_TRUE(world.slam.localize(world.places[7]).is_new);
}

TEST(AppearanceSlam, RefusesAThresholdThatIsNoProbability) {
  AppearanceSlamOptions options;
  options.min_revisit_probability = 0.0;
  EXPECT_THROW(World world(options), InputError);
}

TEST(Belief, SmoothedIsLessSureAndSumsToOne) {
  const Belief sure = posterior(uniform_prior(3), {-1.0, -5000.0, -6000.0}, -7000.0);
  const Belief belief = smoothed(sure, 0.9);
  EXPECT_NEAR(belief.p_place[0], 0.9 + 0.1 / 4, kSumsToOne);
  EXPECT_NEAR(belief.p_place[2], 0.1 / 4, kSumsToOne);
  EXPECT_NEAR(std::accumulate(belief.p_place.begin(), belief.p_place.end(), belief.p_new), 1.0, kSumsToOne);
  EXPECT_NEAR(belief.log_p_place[1], std::log(belief.p_place[1]), kSumsToOne);
  EXPECT_EQ(belief.log_likelihood, sure.log_likelihood);
  EXPECT_EQ(smoothed(sure, 1.0).log_p_place, sure.log_p_place);
  EXPECT_THROW(smoothed(sure, 1.5), InputError);
}

}  // namespace
}  // namespace fabloop
