// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/max_clique.h"

#include <gtest/gtest.h>

#include <random>

namespace fabloop {
namespace {

BitGraph random_graph(std::size_t size, double density, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_joined(density);
  BitGraph graph(size);
  for (std::size_t a = 0; a < size; ++a) {
    for (std::size_t b = a + 1; b < size; ++b) {
      if (is_joined(random)) graph.join(a, b);
    }
  }
  return graph;
}

bool is_clique(const BitGraph& graph, const std::vector<std::size_t>& vertices) {
  for (const std::size_t a : vertices) {
    for (const std::size_t b : vertices) {
      if (a != b && !graph.are_joined(a, b)) return false;
    }
  }
  return true;
}

/// By trying all sets.
std::size_t size_by_trying(const BitGraph& graph) {
  std::size_t best = 0;
  for (std::uint32_t set = 0; set < 1u << graph.size(); ++set) {
    std::vector<std::size_t> vertices;
    for (std::size_t v = 0; v < graph.size(); ++v) {
      if ((set >> v & 1) != 0) vertices.push_back(v);
    }
    if (vertices.size() > best && is_clique(graph, vertices)) best = vertices.size();
  }
  return best;
}

TEST(MaxClique, IsTheLargestOfAllSets) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const BitGraph graph = random_graph(11, 0.2 + 0.01 * seed, seed);
    const Clique clique = max_clique(graph);
    EXPECT_TRUE(clique.is_proven);
    EXPECT_TRUE(is_clique(graph, clique.vertices));
    EXPECT_EQ(clique.vertices.size(), size_by_trying(graph)) << "seed " << seed;
  }
}

TEST(MaxClique, FindsAPlantedOneAmongHundreds) {
  BitGraph graph = random_graph(300, 0.3, 7);
  std::vector<std::size_t> planted;
  for (std::size_t v = 4; v < 300; v += 10) planted.push_back(v);
  for (const std::size_t a : planted) {
    for (const std::size_t b : planted) {
      if (a < b) graph.join(a, b);
    }
  }
  const Clique clique = max_clique(graph);
  EXPECT_TRUE(clique.is_proven);
  EXPECT_EQ(clique.vertices, planted);
}

TEST(MaxClique, StopsAtTheBudgetWithACliqueAndSaysSo) {
  const BitGraph graph = random_graph(200, 0.8, 3);
  MaxCliqueOptions options;
  options.max_work = 5000;
  const Clique clique = max_clique(graph, options);
  EXPECT_FALSE(clique.is_proven);
  EXPECT_LT(clique.work, 10000u);
  EXPECT_TRUE(is_clique(graph, clique.vertices));
  EXPECT_GT(clique.vertices.size(), 10u) << "greedy cliques of this density have more";
}

TEST(MaxClique, ReturnsTheKnownOneUnlessThereIsALarger) {
  BitGraph graph(6);
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}, {3, 4}, {3, 5}, {4, 5}}) {
    graph.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  }
  MaxCliqueOptions options;
  options.known = {3, 4, 5};
  EXPECT_EQ(max_clique(graph, options).vertices, options.known);
  options.known = {0, 1, 2};
  EXPECT_EQ(max_clique(graph, options).vertices, options.known);
  options.known = {0, 1};
  EXPECT_EQ(max_clique(graph, options).vertices.size(), 3u);
}

TEST(MaxClique, OfNothingIsEmptyAndOfLonersOne) {
  EXPECT_TRUE(max_clique(BitGraph(0)).vertices.empty());
  EXPECT_EQ(max_clique(BitGraph(70)).vertices.size(), 1u);
}

TEST(BitGraph, GrowsWithoutLosingWhoIsJoined) {
  BitGraph grown;
  const BitGraph whole = random_graph(150, 0.4, 5);
  for (std::size_t a = 0; a < whole.size(); ++a) {
    EXPECT_EQ(grown.add_vertex(), a);
    for (std::size_t b = 0; b < a; ++b) {
      if (whole.are_joined(a, b)) grown.join(a, b);
    }
  }
  for (std::size_t a = 0; a < whole.size(); ++a) {
    EXPECT_EQ(grown.degree(a), whole.degree(a));
    for (std::size_t b = 0; b < whole.size(); ++b) EXPECT_EQ(grown.are_joined(a, b), whole.are_joined(a, b));
  }
}

}  // namespace
}  // namespace fabloop
