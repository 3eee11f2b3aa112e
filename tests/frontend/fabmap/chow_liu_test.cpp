// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/pair_tables.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using testing_support::random_tree;
using testing_support::TreeSampler;

constexpr double kInformationRounding = 1e-12;

/// A tree whose links are strong enough to be found from a few thousand samples.
ChowLiuTree strongly_linked_tree(std::size_t num_words) {
  ChowLiuTree tree;
  std::mt19937_64 generator(3);
  tree.nodes.push_back({std::nullopt, 0.3, 0.3, 0.3});
  while (tree.num_words() < num_words) {
    tree.nodes.push_back({static_cast<WordId>(generator() % tree.num_words()), 0.3, 0.8, 0.06 / 0.7});
  }
  return tree;
}

/// Keeps all links, however weak.
ChowLiuOptions whole_tree() {
  ChowLiuOptions options;
  options.min_mutual_information = 0.0;
  return options;
}

bool are_equal(const ChowLiuTree& a, const ChowLiuTree& b) {
  return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), [](const auto& x, const auto& y) {
    return x.parent == y.parent && x.p == y.p && x.p_if_parent == y.p_if_parent && x.p_if_no_parent == y.p_if_no_parent;
  });
}

/// Mutual information of two words as training sees it.
double link(const std::vector<Observation>& observations, WordId a, WordId b) {
  std::vector<Observation> pair;
  for (const Observation& observation : observations) {
    Observation& projected = pair.emplace_back();
    for (const WordId word : observation.words) {
      if (word == a) projected.words.push_back(0);
      if (word == b) projected.words.push_back(1);
    }
  }
  return train_chow_liu_tree(pair, 2, whole_tree()).mutual_information;
}

TEST(ChowLiu, RecoversAKnownTreeFromItsSamples) {
  const ChowLiuTree truth = strongly_linked_tree(60);
  const ChowLiuTree tree = train_chow_liu_tree(TreeSampler(truth, 1).draw(4000), 60, whole_tree()).tree;
  constexpr double kSampling = 0.06;  // Five standard deviations of a frequency of 0.8 in 1,200 images.
  for (WordId word = 0; word < 60; ++word) {
    EXPECT_EQ(tree.nodes[word].parent, truth.nodes[word].parent) << word;
    EXPECT_NEAR(tree.nodes[word].p, truth.nodes[word].p, kSampling);
    EXPECT_NEAR(tree.nodes[word].p_if_parent, truth.nodes[word].p_if_parent, kSampling);
    EXPECT_NEAR(tree.nodes[word].p_if_no_parent, truth.nodes[word].p_if_no_parent, kSampling);
  }
}

TEST(ChowLiu, FindsNoLinkBetweenIndependentWords) {
  // Words 0, 1, 2 are seen in 10 %, 1 % and 50 % of the images, in every combination as often as chance has it. Word 3 follows
  // word 0 half of the time.
  std::vector<Observation> observations;
  for (unsigned i = 0; i < 4000; ++i) {
    Observation& observation = observations.emplace_back();
    if (i % 10 == 0) observation.words.push_back(0);
    if (i / 10 % 100 == 0) observation.words.push_back(1);
    if (i / 1000 % 2 == 0) observation.words.push_back(2);
    if (i % 20 == 0) observation.words.push_back(3);
  }
  const double linked = link(observations, 0, 3);
  for (const auto& [a, b] : {std::pair{0u, 1u}, {0u, 2u}, {1u, 2u}}) EXPECT_LT(link(observations, a, b), 1e-3 * linked);
}

TEST(ChowLiu, DoesNotDependOnTheOrderOfImages) {
  std::vector<Observation> observations = TreeSampler(random_tree(80, 0.1, 4), 4).draw(200);
  const ChowLiuResult result = train_chow_liu_tree(observations, 80, whole_tree());
  std::shuffle(observations.begin(), observations.end(), std::mt19937_64(5));
  const ChowLiuResult shuffled = train_chow_liu_tree(observations, 80, whole_tree());
  EXPECT_TRUE(are_equal(result.tree, shuffled.tree));
  EXPECT_EQ(result.mutual_information, shuffled.mutual_information);
}

/// Small random data with words that are never, always, equally often and always together seen: many ties.
std::vector<Observation> observations_with_ties(std::size_t num_words, std::size_t num_images, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::vector<Observation> observations(num_images);
  const std::size_t divisor = 1 + generator() % 6;
  for (Observation& observation : observations) {
    const std::uint64_t bits = generator();
    for (WordId word = 0; word < num_words; ++word) {
      const bool always = word % 7 == 3;
      const bool never = word % 7 == 5;
      const bool twin = word % 7 == 2;  // Of all its like.
      const bool seen = twin ? (bits & 1) != 0 : generator() % (1 + divisor * (word % 3)) == 0;
      if (always || (seen && !never)) observation.words.push_back(word);
    }
  }
  return observations;
}

struct Edge {
  WordId a = 0, b = 0;
  double mutual_information = 0.0;
};

/// All pairs of words, straight from the definition.
std::vector<Edge> all_edges(const std::vector<Observation>& observations, std::size_t num_words) {
  std::vector<ImageCount> counts(num_words, 0);
  std::vector<std::vector<ImageCount>> both(num_words, std::vector<ImageCount>(num_words, 0));
  for (const Observation& observation : observations) {
    for (const WordId a : observation.words) {
      ++counts[a];
      for (const WordId b : observation.words) ++both[a][b];
    }
  }
  const PairTables tables(counts, static_cast<ImageCount>(observations.size()), 1.0);
  std::vector<Edge> edges;
  for (WordId a = 0; a < num_words; ++a) {
    for (WordId b = 0; b < a; ++b) edges.push_back({a, b, tables.mutual_information(counts[a], counts[b])(both[a][b])});
  }
  return edges;
}

/// The strengths of the links of a maximum spanning tree, the strongest first: the same for all such trees (Kruskal 1956).
std::vector<double> kruskal(std::vector<Edge> edges, std::size_t num_words) {
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.mutual_information > y.mutual_information; });
  std::vector<WordId> group(num_words);
  std::iota(group.begin(), group.end(), WordId{0});
  std::vector<double> strengths;
  for (const Edge& edge : edges) {
    const WordId from = group[edge.a], to = group[edge.b];
    if (from == to) continue;
    std::replace(group.begin(), group.end(), from, to);
    strengths.push_back(edge.mutual_information);
  }
  return strengths;
}

/// The parents that the rule for ties asks for: the best link out of the tree so far, lower words first, then lower parents.
std::vector<std::optional<WordId>> prim(const std::vector<Edge>& edges, std::size_t num_words) {
  std::vector<std::optional<WordId>> parents(num_words);
  std::vector<char> inside(num_words, 0);
  inside[0] = 1;
  for (std::size_t step = 1; step < num_words; ++step) {
    Edge best{0, 0, -std::numeric_limits<double>::infinity()};
    for (Edge edge : edges) {
      if (inside[edge.a] == inside[edge.b]) continue;
      if (inside[edge.a]) std::swap(edge.a, edge.b);
      const auto rank = [](const Edge& e) { return std::tuple(-e.mutual_information, e.a, e.b); };
      if (rank(edge) < rank(best)) best = edge;
    }
    inside[best.a] = 1;
    parents[best.a] = best.b;
  }
  return parents;
}

TEST(ChowLiu, IsTheMaximumSpanningTreeOfAllPairs) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::size_t num_words = 1 + seed % 40;
    const std::vector<Observation> observations = observations_with_ties(num_words, 1 + seed * 7 % 31, seed);
    const std::vector<Edge> edges = all_edges(observations, num_words);
    const ChowLiuTree tree = train_chow_liu_tree(observations, num_words, whole_tree()).tree;
    std::vector<double> strengths;
    for (const Edge& edge : edges) {
      const bool linked = tree.nodes[edge.a].parent == edge.b || tree.nodes[edge.b].parent == edge.a;
      if (linked) strengths.push_back(edge.mutual_information);
    }
    // A link of no information at all may come out below zero by rounding, and is then cut.
    std::vector<double> expected = kruskal(edges, num_words);
    std::erase_if(expected, [](double strength) { return strength < 0.0; });
    std::sort(strengths.rbegin(), strengths.rend());
    EXPECT_EQ(strengths, expected) << seed;
    const auto parents = prim(edges, num_words);
    for (WordId word = 0; word < num_words; ++word) {
      if (tree.nodes[word].parent) {
        EXPECT_EQ(tree.nodes[word].parent, parents[word]) << seed << " " << word;
      }
    }
  }
}

TEST(ChowLiu, IsTheMaximumSpanningTreeOfManyWords) {
  // More words than one block of equal counts holds, most of which are seen together with few others.
  constexpr std::size_t kNumWords = 700;
  const std::vector<Observation> observations = TreeSampler(random_tree(kNumWords, 0.01, 8), 8).draw(60);
  const std::vector<Edge> edges = all_edges(observations, kNumWords);
  const std::vector<double> expected = kruskal(edges, kNumWords);
  const double sum = std::accumulate(expected.begin(), expected.end(), 0.0);
  EXPECT_NEAR(train_chow_liu_tree(observations, kNumWords, whole_tree()).mutual_information, sum, 1e-9 * sum);
}

TEST(ChowLiu, TakesAllProbabilitiesFromOneTable) {
  const std::vector<Observation> observations = TreeSampler(random_tree(40, 0.2, 6), 6).draw(30);
  const ChowLiuTree tree = train_chow_liu_tree(observations, 40, whole_tree()).tree;
  for (const ChowLiuNode& node : tree.nodes) {
    if (!node.parent) continue;
    const double parent_p = tree.nodes[*node.parent].p;
    EXPECT_NEAR(node.p_if_parent * parent_p + node.p_if_no_parent * (1.0 - parent_p), node.p, kInformationRounding);
  }
}

TEST(ChowLiu, NeverCallsTheUnseenImpossible) {
  // Word 0 is always seen, word 2 never.
  const std::vector<Observation> observations = {{{0, 1}}, {{0}}, {{0, 1, 3}}};
  EXPECT_NO_THROW(validate(train_chow_liu_tree(observations, 4).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{}, {}}, 3).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{{0, 1}}}, 2).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{{0}}}, 1).tree, "tree"));
}

TEST(ChowLiu, CutsWeakLinks) {
  const std::vector<Observation> observations = TreeSampler(strongly_linked_tree(20), 2).draw(500);
  ChowLiuOptions options;
  options.min_mutual_information = std::numeric_limits<double>::infinity();
  const ChowLiuTree cut = train_chow_liu_tree(observations, 20, options).tree;
  EXPECT_TRUE(are_equal(cut, naive_bayes(train_chow_liu_tree(observations, 20).tree)));
  EXPECT_EQ(parents_first(cut).size(), 20u);
}

TEST(ChowLiu, CutsWhatChanceWouldLink) {
  // Independent words of few images: the best links of all pairs look strong. Of 20 draws at most a few may slip through.
  std::size_t num_links = 0, num_draws = 20;
  for (std::uint64_t seed = 1; seed <= num_draws; ++seed) {
    const ChowLiuTree independent = naive_bayes(strongly_linked_tree(200));
    for (const ChowLiuNode& node : train_chow_liu_tree(TreeSampler(independent, seed).draw(60), 200).tree.nodes) {
      num_links += node.parent.has_value() ? 1 : 0;
    }
  }
  EXPECT_LE(num_links, num_draws);
  // Where the images tell, links stay.
  const ChowLiuTree linked = train_chow_liu_tree(TreeSampler(strongly_linked_tree(20), 3).draw(500), 20).tree;
  EXPECT_GE(
      std::count_if(linked.nodes.begin(), linked.nodes.end(), [](const ChowLiuNode& node) { return node.parent.has_value(); }),
      15);
}

TEST(ChowLiu, RefusesWhatIsNoTraining) {
  EXPECT_THROW(train_chow_liu_tree({}, 3), InputError);
  EXPECT_THROW(train_chow_liu_tree({{}}, 0), InputError);
  EXPECT_THROW(train_chow_liu_tree({{{3}}}, 3), InputError);
  ChowLiuOptions options;
  options.pseudo_count = 0.0;
  EXPECT_THROW(train_chow_liu_tree({{}}, 3, options), InputError);
}

TEST(ChowLiu, RefusesTreesThatAreNone) {
  const ChowLiuNode good = {std::nullopt, 0.2, 0.2, 0.2};
  EXPECT_NO_THROW(validate(ChowLiuTree{{good, good}}, "tree"));
  EXPECT_THROW(validate(ChowLiuTree{}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {7, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {1, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {2, 0.2, 0.2, 0.2}, {1, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  for (const double bad : {0.0, 1.0, -0.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(validate(ChowLiuTree{{good, {0, 0.2, bad, 0.2}}}, "tree"), InputError);
  }
}

}  // namespace
}  // namespace fabloop
