// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/hypotheses.h"

#include <gtest/gtest.h>

namespace fabloop {
namespace {

constexpr double kProbabilityRounding = 1e-12;

std::vector<PlaceId> places(const std::vector<Hypothesis>& hypotheses) {
  std::vector<PlaceId> result;
  for (const Hypothesis& hypothesis : hypotheses) result.push_back(hypothesis.place);
  return result;
}

TEST(RankedHypotheses, OrdersByProbabilityThenByIndex) {
  const Belief belief = posterior(uniform_prior(4), {-2.0, -1.0, -2.0, -3.0}, -1.0);
  const auto ranked = ranked_hypotheses(belief, {10, 0, 0.0});
  EXPECT_EQ(places(ranked), (std::vector<PlaceId>{1, 0, 2, 3}));
  for (const Hypothesis& hypothesis : ranked) {
    EXPECT_NEAR(hypothesis.probability, belief.p_place[hypothesis.place], kProbabilityRounding);
    EXPECT_EQ(hypothesis.log_likelihood, belief.log_likelihood[hypothesis.place]);
  }
  EXPECT_EQ(places(ranked_hypotheses(belief, {2, 0, 0.0})), (std::vector<PlaceId>{1, 0}));
}

TEST(RankedHypotheses, LeavesRecentPlacesOutOfTheNormalisation) {
  // The last two places look like the present one and take nearly all probability; place 0 is the true revisit.
  const Belief belief = posterior(uniform_prior(4), {-20.0, -30.0, 0.0, 0.0}, -30.0);
  EXPECT_LT(belief.p_place[0], 1e-8);
  const auto ranked = ranked_hypotheses(belief, {10, 2, 0.5});
  EXPECT_EQ(places(ranked), (std::vector<PlaceId>{0}));
  EXPECT_GT(ranked[0].probability, 0.999);
  const Belief without = posterior(without_recent_places(uniform_prior(4), 2), {-20.0, -30.0, 0.0, 0.0}, -30.0);
  EXPECT_NEAR(ranked[0].probability, without.p_place[0], kProbabilityRounding);
}

TEST(WithoutRecentPlaces, OfABeliefIsAsOfItsPrior) {
  const Prior prior = {0.2, {0.1, 0.3, 0.15, 0.25}};
  for (const double log_likelihood_recent : {-1.0, 900.0}) {
    const std::vector<double> log_likelihood = {-20.0, -22.0, log_likelihood_recent, log_likelihood_recent};
    const Belief of_belief = without_recent_places(posterior(prior, log_likelihood, -21.0), 2);
    const Belief of_prior = posterior(without_recent_places(prior, 2), log_likelihood, -21.0);
    EXPECT_NEAR(of_belief.p_new, of_prior.p_new, kProbabilityRounding);
    EXPECT_NEAR(of_belief.log_p_new, of_prior.log_p_new, kProbabilityRounding);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(of_belief.log_p_place[i], of_prior.log_p_place[i], kProbabilityRounding);
    EXPECT_EQ(of_belief.p_place[3], 0.0);
    EXPECT_EQ(of_belief.log_likelihood, log_likelihood);
  }
  EXPECT_EQ(without_recent_places(posterior(prior, {0, 0, 0, 0}, -1e9), 7).p_new, 1.0);
}

TEST(RankedHypotheses, OrdersByLogLikelihoodWhereProbabilitiesUnderflow) {
  const Belief belief = posterior(uniform_prior(4), {-5000.0, -4000.0, -6000.0, 0.0}, -4001.0);
  EXPECT_EQ(belief.p_place[1], 0.0);
  const auto ranked = ranked_hypotheses(belief, {10, 1, 0.0});
  EXPECT_EQ(places(ranked), (std::vector<PlaceId>{1, 0, 2}));
  EXPECT_GT(ranked[0].probability, 0.3);
  EXPECT_EQ(places(ranked_hypotheses(belief, {10, 0, 0.0})), (std::vector<PlaceId>{3, 1, 0, 2}));
}

TEST(RankedHypotheses, LeavesOutWhatThePriorRulesOut) {
  const Belief belief = posterior({0.5, {0.0, 0.5}}, {0.0, -10.0}, -5.0);
  EXPECT_EQ(places(ranked_hypotheses(belief, {10, 0, 0.0})), (std::vector<PlaceId>{1}));
}

TEST(RankedHypotheses, AreNoneOnAnEmptyMapOrWhenAllIsRecent) {
  EXPECT_TRUE(ranked_hypotheses(posterior(uniform_prior(0), {}, -3.0)).empty());
  EXPECT_TRUE(ranked_hypotheses(posterior(uniform_prior(3), {-1.0, -1.0, -1.0}, -3.0)).empty());
}

}  // namespace
}  // namespace fabloop
