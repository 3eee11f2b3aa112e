// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/word_matching.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "verification/matching/feature_distances.h"
#include "verification/matching/nearest_features.h"
#include "verification/matching/spots.h"

namespace fabloop {
namespace {

constexpr float kNotSeen = std::numeric_limits<float>::infinity();

/// Features sorted by word, those of one word by index.
std::vector<int> by_word(std::span<const WordId> words) {
  std::vector<int> order(words.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return words[static_cast<std::size_t>(a)] < words[static_cast<std::size_t>(b)]; });
  return order;
}

/// The features of the word that the first of `sorted` has.
std::span<const int> first_word(std::span<const int> sorted, std::span<const WordId> words) {
  const WordId word = words[static_cast<std::size_t>(sorted.front())];
  std::size_t count = 1;
  while (count < sorted.size() && words[static_cast<std::size_t>(sorted[count])] == word) ++count;
  return sorted.first(count);
}

/// A match within a word, and what it is sorted by.
struct WordMatch {
  Match match;
  std::size_t num_pairs = 0;  ///< Of features of the word.
  float distance = 0;         ///< Squared.
};

/// Matches the features of one word.
void match_word(const Features& query, std::span<const int> query_members, const Features& match,
                std::span<const int> match_members, float max_distance, const MatchingOptions& options,
                std::vector<WordMatch>& found) {
  std::vector<float> to_nearest_query(match_members.size(), kNotSeen);
  std::vector<NearestFeature> nearest;
  std::vector<float> distances(match_members.size());
  for (const int q : query_members) {
    for (std::size_t i = 0; i < match_members.size(); ++i) {
      distances[i] = squared_distance_between(query, q, match, match_members[i]);
      to_nearest_query[i] = std::min(to_nearest_query[i], distances[i]);
    }
    NearestFeature best = nearest_of(match_members, distances, match, options.same_spot_px);
    // Its place in the word, as in to_nearest_query.
    best.index =
        static_cast<int>(std::lower_bound(match_members.begin(), match_members.end(), best.index) - match_members.begin());
    nearest.push_back(best);
  }
  nearest = only_mutual(std::move(nearest), std::move(to_nearest_query));
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].index < 0 || nearest[i].distance > max_distance) continue;
    const float ratio = distance_ratio(nearest[i].distance, nearest[i].second_distance);
    if (ratio > options.max_ratio) continue;
    const int m = match_members[static_cast<std::size_t>(nearest[i].index)];
    found.push_back(
        {{query_members[i], m, ratio, RatioAmong::SameWord}, query_members.size() * match_members.size(), nearest[i].distance});
  }
}

/// Of all words that both sides have, the rarest first.
std::vector<WordMatch> matches_of_words(const Features& query, std::span<const WordId> words_of_query, const Features& match,
                                        std::span<const WordId> words_of_match, const WordMatchingOptions& options) {
  const double typical = static_cast<double>(typical_squared_distance(query, match));
  const auto max_distance = static_cast<float>(options.max_relative_distance * options.max_relative_distance * typical);
  const std::vector<int> query_order = by_word(words_of_query), match_order = by_word(words_of_match);
  std::span<const int> query_rest(query_order), match_rest(match_order);
  std::vector<WordMatch> found;
  while (!query_rest.empty() && !match_rest.empty()) {
    const WordId word = words_of_query[static_cast<std::size_t>(query_rest.front())];
    const WordId other_word = words_of_match[static_cast<std::size_t>(match_rest.front())];
    const auto query_members = first_word(query_rest, words_of_query), match_members = first_word(match_rest, words_of_match);
    if (word == other_word) match_word(query, query_members, match, match_members, max_distance, options.matching, found);
    if (word <= other_word) query_rest = query_rest.subspan(query_members.size());
    if (other_word <= word) match_rest = match_rest.subspan(match_members.size());
  }
  std::stable_sort(found.begin(), found.end(), [](const WordMatch& a, const WordMatch& b) {
    if (a.num_pairs != b.num_pairs) return a.num_pairs < b.num_pairs;
    return a.match.ratio != b.match.ratio ? a.match.ratio < b.match.ratio : a.distance < b.distance;
  });
  return found;
}

}  // namespace

std::vector<Match> match_shared_words(const Features& query, std::span<const WordId> query_words, const Features& match,
                                      std::span<const WordId> match_words, const WordMatchingOptions& options) {
  assert(query.descriptor_kind == match.descriptor_kind);
  assert(query_words.size() == query.keypoints.size() && match_words.size() == match.keypoints.size());
  if (query.keypoints.empty() || match.keypoints.empty()) return {};
  std::vector<Match> matches;
  std::vector<char> query_has(query.keypoints.size(), 0), match_has(match.keypoints.size(), 0);
  for (const WordMatch& found : matches_of_words(query, query_words, match, match_words, options)) {
    matches.push_back(found.match);
    query_has[static_cast<std::size_t>(found.match.query)] = match_has[static_cast<std::size_t>(found.match.match)] = 1;
  }
  if (matches.size() < options.min_matches) {
    for (const Match& found : match_features(query, match, options.matching)) {
      const bool is_of_rest =
          query_has[static_cast<std::size_t>(found.query)] == 0 && match_has[static_cast<std::size_t>(found.match)] == 0;
      if (is_of_rest) matches.push_back(found);
    }
  }
  const double same_spot_px = options.matching.same_spot_px;
  return same_spot_px > 0 ? one_a_spot(matches, query, same_spot_px) : matches;
}

}  // namespace fabloop
