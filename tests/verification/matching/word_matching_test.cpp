// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/word_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

constexpr MatchingOptions kEverySpot{.same_spot_px = 0};

/// The word of feature i is i modulo their number on both sides, but for the share of the query's that got a word of their own.
std::vector<WordId> words_of(std::size_t count, std::size_t num_words, double lost_share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::bernoulli_distribution is_lost(lost_share);
  std::vector<WordId> words;
  for (std::size_t i = 0; i < count; ++i) {
    words.push_back(static_cast<WordId>(is_lost(random) ? num_words + i : i % num_words));
  }
  return words;
}

TEST(WordMatching, FindsTheTruePairsOfSharedWords) {
  const TwoViews world = make_two_views({.num_points = 400});
  const auto words = words_of(400, 150, 0, 1);
  const auto matches =
      match_shared_words(world.query.features, words, world.match.features, words, {.matching = kEverySpot, .min_matches = 0});
  EXPECT_EQ(matches.size(), 400u);
  for (const Match& match : matches) {
    EXPECT_EQ(match.query, match.match);
    EXPECT_EQ(match.ratio_among, RatioAmong::SameWord);
  }
}

TEST(WordMatching, ComparesOnlyWithinAWord) {
  const TwoViews world = make_two_views({.num_points = 300});
  const auto query_words = words_of(300, 100, 0.4, 2), match_words = words_of(300, 100, 0, 3);
  const auto matches = match_shared_words(world.query.features, query_words, world.match.features, match_words,
                                          {.matching = kEverySpot, .min_matches = 0});
  ASSERT_FALSE(matches.empty());
  for (const Match& match : matches) {
    EXPECT_EQ(query_words[static_cast<std::size_t>(match.query)], match_words[static_cast<std::size_t>(match.match)]);
  }
}

TEST(WordMatching, DrawsRareWordsFirst) {
  TwoViews world = make_two_views({.num_points = 300});
  world.query.features.descriptors += 0.1;                                           // no distance is 0
  std::vector<WordId> words(300, 7);                                                 // one word that says nothing,
  for (std::size_t i = 0; i < 60; ++i) words[i] = static_cast<WordId>(100 + i / 2);  // thirty of two features,
  for (std::size_t i = 60; i < 100; ++i) words[i] = static_cast<WordId>(200 + i);    // and forty of one
  const auto matches =
      match_shared_words(world.query.features, words, world.match.features, words, {.matching = kEverySpot, .min_matches = 0});
  ASSERT_EQ(matches.size(), 300u);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const int feature = matches[i].query;
    const int group = feature >= 100 ? 2 : (feature < 60 ? 1 : 0);
    EXPECT_EQ(group, i < 40 ? 0 : (i < 100 ? 1 : 2)) << i;
    EXPECT_EQ(matches[i].ratio == 0, group == 0) << "only the words of one feature have no second";
  }
}

TEST(WordMatching, SearchesTheRestExactlyWhereWordsFindTooFew) {
  const TwoViews world = make_two_views({.num_points = 300});
  const auto query_words = words_of(300, 100, 0.8, 2), match_words = words_of(300, 100, 0, 3);
  WordMatchingOptions options{.matching = kEverySpot, .min_matches = 100};
  const auto matches = match_shared_words(world.query.features, query_words, world.match.features, match_words, options);
  EXPECT_EQ(matches.size(), 300u);
  std::set<int> queries;
  for (const Match& match : matches) {
    EXPECT_EQ(match.query, match.match);
    queries.insert(match.query);
  }
  EXPECT_EQ(queries.size(), 300u) << "a feature was matched twice";
  const auto of_words = [](const Match& match) { return match.ratio_among == RatioAmong::SameWord; };
  EXPECT_TRUE(std::is_partitioned(matches.begin(), matches.end(), of_words));
  EXPECT_LT(std::count_if(matches.begin(), matches.end(), of_words), 100);
}

TEST(WordMatching, TakesNothingThatLooksUnlike) {
  TwoViews world = make_two_views({.num_points = 200});
  cv::flip(world.query.features.descriptors, world.query.features.descriptors, 0);  // each feature has another one's
  std::vector<WordId> words(200);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<WordId>(i);
  // Every word has one feature a side, which no ratio test could refuse; one in 500 is so near by chance.
  EXPECT_LE(
      match_shared_words(world.query.features, words, world.match.features, words, {.matching = {}, .min_matches = 0}).size(),
      2u);
}

TEST(WordMatching, NothingMatchesNothing) { EXPECT_TRUE(match_shared_words({}, {}, {}, {}).empty()); }

}  // namespace
}  // namespace fabloop
