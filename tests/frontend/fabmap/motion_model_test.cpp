// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/motion_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kMotionRounding = 1e-12;

double sum(const Prior& prior) { return std::accumulate(prior.p_place.begin(), prior.p_place.end(), prior.p_new); }

/// A belief that the camera is at one place.
Belief at(std::size_t place, std::size_t num_places) {
  Belief belief;
  belief.p_new = 0.0;
  belief.p_place.assign(num_places, 0.0);
  belief.p_place[place] = 1.0;
  return belief;
}

TEST(MotionModel, GivesAPriorThatSumsToOne) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const std::size_t num_places = 1 + generator() % 20;
    Belief belief;
    belief.p_new = unit(generator);
    for (std::size_t place = 0; place < num_places; ++place) belief.p_place.push_back(unit(generator));
    const double total = std::accumulate(belief.p_place.begin(), belief.p_place.end(), belief.p_new);
    belief.p_new /= total;
    for (double& p : belief.p_place) p /= total;
    const MotionModel motion = {unit(generator), unit(generator), generator() % 5, unit(generator)};
    for (const std::size_t added : {0u, 1u}) {
      const Prior prior = predict(motion, belief, num_places + added);
      EXPECT_EQ(prior.p_place.size(), num_places + added);
      EXPECT_NEAR(sum(prior), 1.0, kMotionRounding);
      for (const double p : prior.p_place) EXPECT_GE(p, 0.0);
    }
  }
}

TEST(MotionModel, MovesForwardTowardsHigherPlaces) {
  const Prior forward = predict({0.0, 0.0, 1, 1.0}, at(5, 11), 11);
  EXPECT_NEAR(forward.p_place[5], 1.0 / 3.0, kMotionRounding);
  EXPECT_NEAR(forward.p_place[6], 2.0 / 3.0, kMotionRounding);
  const Prior backward = predict({0.0, 0.0, 1, 0.0}, at(5, 11), 11);
  EXPECT_NEAR(backward.p_place[4], 2.0 / 3.0, kMotionRounding);
  EXPECT_EQ(backward.p_place[6], 0.0);
  const Prior either = predict({0.0, 0.0, 2, 0.5}, at(5, 11), 11);
  for (std::size_t place = 3; place <= 7; ++place) EXPECT_NEAR(either.p_place[place], 0.2, kMotionRounding);
}

TEST(MotionModel, LeavesTheRouteIntoNewPlaces) {
  const Prior prior = predict({0.0, 0.0, 1, 0.5}, at(10, 11), 11);
  EXPECT_NEAR(prior.p_new, 1.0 / 3.0, kMotionRounding);
  EXPECT_NEAR(prior.p_place[9], 1.0 / 3.0, kMotionRounding);
}

TEST(MotionModel, TeleportsAnywhere) {
  const Prior prior = predict({0.2, 1.0, 1, 0.5}, at(3, 10), 10);
  EXPECT_NEAR(prior.p_new, 0.2, kMotionRounding);
  for (const double p : prior.p_place) EXPECT_NEAR(p, 0.08, kMotionRounding);
}

TEST(MotionModel, KnowsThatAnAddedPlaceIsWhereTheCameraWas) {
  Belief belief;  // Surely new, on an empty map.
  const Prior prior = predict({0.5, 0.0, 0, 0.5}, belief, 1);
  EXPECT_NEAR(prior.p_place[0], 0.5, kMotionRounding);
  EXPECT_EQ(predict({0.5, 0.0, 0, 0.5}, belief, 0).p_new, 1.0);
}

TEST(MotionModel, RefusesWhatIsNoProbability) {
  EXPECT_THROW(predict({1.1, 0.5, 1, 0.5}, at(0, 2), 2), InputError);
  EXPECT_THROW(predict({0.5, std::numeric_limits<double>::quiet_NaN(), 1, 0.5}, at(0, 2), 2), InputError);
  EXPECT_THROW(predict({}, at(0, 2), 1), InputError);
  EXPECT_THROW(predict({}, at(0, 2), 4), InputError);
}

TEST(Prior, IsUniformWithoutKnowledge) {
  EXPECT_EQ(uniform_prior(0, 0.3).p_new, 1.0);
  EXPECT_NEAR(sum(uniform_prior(7, 0.3)), 1.0, kMotionRounding);
  EXPECT_NEAR(uniform_prior(7, 0.3).p_place[6], 0.1, kMotionRounding);
}

TEST(Prior, LeavesOutRecentPlaces) {
  const Prior prior = without_recent_places(Prior{0.2, {0.1, 0.3, 0.4}}, 2);
  EXPECT_NEAR(prior.p_new, 2.0 / 3.0, kMotionRounding);
  EXPECT_NEAR(prior.p_place[0], 1.0 / 3.0, kMotionRounding);
  EXPECT_EQ(prior.p_place[1] + prior.p_place[2], 0.0);
  EXPECT_EQ(without_recent_places(Prior{0.0, {0.0, 1.0}}, 1).p_new, 1.0);
  EXPECT_EQ(without_recent_places(uniform_prior(2), 5).p_new, 1.0);
}

Belief random_belief(std::size_t num_places, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> log_likelihood;
  for (std::size_t i = 0; i < num_places; ++i) log_likelihood.push_back(5.0 * unit(generator));
  return posterior(uniform_prior(num_places), log_likelihood, 5.0 * unit(generator));
}

TEST(MotionModel, TheGraphOfARouteIsTheRoute) {
  std::mt19937_64 generator(1);
  for (std::size_t num_places = 1; num_places < 12; ++num_places) {
    const MotionModel motion = {0.2, 0.3, num_places % 4, 0.8};
    const Belief belief = random_belief(num_places, generator);
    for (const std::size_t now : {num_places, num_places + 1}) {
      const Prior by_route = predict(motion, belief, now);
      const Prior by_graph = predict(motion, belief, route(now));
      EXPECT_NEAR(by_graph.p_new, by_route.p_new, kMotionRounding);
      for (std::size_t i = 0; i < now; ++i) EXPECT_NEAR(by_graph.p_place[i], by_route.p_place[i], kMotionRounding);
    }
  }
}

TEST(MotionModel, FollowsTheLinksOfAGraph) {
  // A crossing: from place 0 to 1 or 2; both lead to 3, which leads back to 0.
  PlaceGraph graph;
  for (const auto& [from, to] : std::vector<std::pair<PlaceId, PlaceId>>{{0, 1}, {0, 2}, {1, 3}, {2, 3}, {3, 0}})
    link(graph, from, to);
  Belief at_crossing;
  at_crossing.p_new = 0.0;
  at_crossing.p_place = {1.0, 0.0, 0.0, 0.0};
  const Prior forward = predict({0.0, 0.0, 2, 1.0}, at_crossing, graph);
  // A fifth each: staying; four fifths go on, half of them by one link, half by two.
  EXPECT_NEAR(forward.p_place[0], 0.2, kMotionRounding);
  EXPECT_NEAR(forward.p_place[1], 0.2, kMotionRounding);
  EXPECT_NEAR(forward.p_place[2], 0.2, kMotionRounding);
  EXPECT_NEAR(forward.p_place[3], 0.4, kMotionRounding);
  EXPECT_NEAR(forward.p_new, 0.0, kMotionRounding);
  const Prior backward = predict({0.0, 0.0, 1, 0.0}, at_crossing, graph);
  EXPECT_NEAR(backward.p_place[3], 2.0 / 3.0, kMotionRounding);
}

TEST(MotionModel, LeavesTheGraphWhereNoLinkGoesOn) {
  PlaceGraph graph;
  link(graph, 0, 1);
  Belief at_end;
  at_end.p_new = 0.0;
  at_end.p_place = {0.0, 1.0};
  const Prior prior = predict({0.0, 0.0, 1, 1.0}, at_end, graph);
  EXPECT_NEAR(prior.p_place[1], 1.0 / 3.0, kMotionRounding);
  EXPECT_NEAR(prior.p_new, 2.0 / 3.0, kMotionRounding);
  graph.next[1].push_back(7);
  EXPECT_THROW(predict({}, at_end, graph), InputError);
}

}  // namespace
}  // namespace fabloop
