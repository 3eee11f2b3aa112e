// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/observation_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frontend/error.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

constexpr double kModelRounding = 1e-12;

ObservationModel four_words() {
  return {{{{std::nullopt, 0.3, 0.3, 0.3}, {0, 0.2, 0.4, 4.0 / 35.0}, {0, 0.25, 0.1, 11.0 / 35.0}, {2, 0.1, 0.3, 1.0 / 30.0}}},
          {0.39, 0.01}};
}

PlaceModel place_of(const std::vector<Observation>& visits) {
  PlaceModel place;
  for (const Observation& visit : visits) add_visit(place, visit);
  return place;
}

// tests/golden/fabmap_four_words.py
TEST(ObservationModel, MatchesTheNumbersEnumeratedByHand) {
  const ObservationModel model = four_words();
  EXPECT_NEAR(log_likelihood(model, place_of({}), {{0, 1}}), -2.479387658494363, kModelRounding);
  EXPECT_NEAR(log_likelihood(model, place_of({{{0, 2}}}), {{0, 1}}), -2.529581568558137, kModelRounding);
  EXPECT_NEAR(log_likelihood(model, place_of({{{0, 2}}, {{1, 2}}}), {{0, 1}}), -1.668271316644424, kModelRounding);
  EXPECT_NEAR(log_likelihood(model, place_of({{{0, 2}}}), {{0, 2}}), -3.156901598205921, kModelRounding);
  EXPECT_NEAR(log_likelihood(model, place_of({{{0, 2}}}), {}), -1.240241675169446, kModelRounding);
}

TEST(ObservationModel, SumsToOneOverAllObservations) {
  const ObservationModel model = four_words();
  for (const auto& visits : std::vector<std::vector<Observation>>{{}, {{{1}}}, {{{0, 3}}, {{0}}, {}}}) {
    double sum = 0.0;
    for (unsigned bits = 0; bits < 16; ++bits) {
      Observation observation;
      for (WordId word = 0; word < 4; ++word) {
        if ((bits >> word) & 1u) observation.words.push_back(word);
      }
      sum += std::exp(log_likelihood(model, place_of(visits), observation));
    }
    EXPECT_NEAR(sum, 1.0, kModelRounding);
  }
}

TEST(ObservationModel, ExpectsTheMarginalsAtANewPlaceWhenLinksAreCut) {
  ObservationModel model = four_words();
  model.tree = naive_bayes(model.tree);
  for (WordId word = 0; word < 4; ++word) {
    const auto log_p = log_p_word(model, word, 0, 0);
    EXPECT_NEAR(std::exp(log_p[static_cast<std::size_t>(WordState::SeenParentUnseen)]), model.tree.nodes[word].p, kModelRounding);
  }
}

TEST(ObservationModel, FollowsTheParentWhenTheElementSaysNothing) {
  // With equal detection rates, e tells nothing about z, and the Chow-Liu link alone is left.
  const ChowLiuNode node = {0, 0.2, 0.4, 4.0 / 35.0};
  const DetectorModel blind = {0.3, 0.3};
  const double with_parent = p_word(node, blind, WordState::SeenWithParent, true);
  const double without_parent = p_word(node, blind, WordState::SeenParentUnseen, true);
  EXPECT_GT(with_parent, without_parent);
  EXPECT_NEAR(with_parent + p_word(node, blind, WordState::UnseenParentSeen, true), 1.0, kModelRounding);
  const DetectorModel marginal = {0.2, 0.2};
  EXPECT_NEAR(p_word(node, marginal, WordState::SeenWithParent, true), 0.4, kModelRounding);
  EXPECT_NEAR(p_word(node, marginal, WordState::SeenParentUnseen, false), 4.0 / 35.0, kModelRounding);
}

TEST(DetectorModel, CountsEveryVisit) {
  const DetectorModel detector = {0.39, 0.01};
  double p = p_present_anywhere(detector, 0.1);
  const bool seen_at[] = {true, false, false, true, false};
  std::uint32_t detections = 0;
  for (std::uint32_t visit = 0; visit < 5; ++visit) {
    const double here = p * p_seen_given_present(detector, seen_at[visit], true);
    p = here / (here + (1.0 - p) * p_seen_given_present(detector, seen_at[visit], false));
    detections += seen_at[visit] ? 1 : 0;
    EXPECT_NEAR(p_present(detector, 0.1, visit + 1, detections), p, kModelRounding);
  }
}

TEST(DetectorModel, IsCertainOfWhatItSawWhenItNeverErrs) {
  EXPECT_EQ(p_present({0.39, 0.0}, 0.1, 100, 1), 1.0);
  EXPECT_LT(p_present({0.39, 0.0}, 0.1, 100, 0), 1e-6);
  EXPECT_GT(p_present({0.39, 0.0}, 0.9, 0, 0), 0.99);
}

TEST(DetectorModel, RefusesImpossibleRates) {
  EXPECT_NO_THROW(validate(DetectorModel{}, "here"));
  for (const DetectorModel bad : {DetectorModel{1.0, 0.0}, DetectorModel{0.3, 0.3}, DetectorModel{0.3, -0.1},
                                  DetectorModel{std::numeric_limits<double>::quiet_NaN(), 0.0}}) {
    EXPECT_THROW(validate(bad, "here"), InputError);
  }
}

TEST(ObservationModel, RefusesWordsThatTheTreeDoesNotHave) {
  EXPECT_THROW(log_likelihood(four_words(), {}, {{4}}), InputError);
  EXPECT_THROW(log_likelihood(four_words(), {}, {{2, 1}}), InputError);
  EXPECT_THROW(log_likelihood(four_words(), {}, {{1, 1}}), InputError);
}

}  // namespace
}  // namespace fabloop
