// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fabloop {

/// An undirected graph as a matrix of bits: who is joined to whom.
class BitGraph {
 public:
  using Word = std::uint64_t;

  explicit BitGraph(std::size_t size = 0);

  std::size_t size() const { return size_; }
  /// Joins two different vertices.
  void join(std::size_t a, std::size_t b);
  bool are_joined(std::size_t a, std::size_t b) const { return (row(a)[b / 64] >> (b % 64) & 1) != 0; }
  /// Number of vertices joined to this one.
  std::size_t degree(std::size_t a) const;
  /// The neighbours of a vertex, 64 a word.
  const Word* row(std::size_t a) const { return bits_.data() + a * num_words_; }
  std::size_t num_words() const { return num_words_; }
  /// One vertex more, joined to none.
  std::size_t add_vertex();

 private:
  std::size_t size_ = 0, num_words_ = 0;
  std::vector<Word> bits_;
};

/// What max_clique() may be told.
struct MaxCliqueOptions {
  /// The search ends after so much work, with the best clique so far: a bound on time that gives the same answer on every
  /// machine. The unit is a word of 64 neighbours looked at; about a billion a second.
  std::size_t max_work = 2'000'000'000;
  /// A clique that is known: it is returned unless a larger one is found.
  std::vector<std::size_t> known = {};
};

/// The most vertices that are all joined to one another.
struct Clique {
  std::vector<std::size_t> vertices;  ///< Ascending.
  bool is_proven = true;              ///< False: the search was ended by `max_work`, and a larger one may be.
  std::size_t work = 0;
};

/// Exact maximum clique: branch and bound in which the number of colours that a greedy colouring needs bounds the clique from
/// above, over sets of bits (Tomita & Seki, DMTCS 2003, and San Segundo et al., An exact bit-parallel algorithm for the maximum
/// clique problem, Computers & Operations Research 2011), begun from the best of greedy cliques.
Clique max_clique(const BitGraph& graph, const MaxCliqueOptions& options = {});

}  // namespace fabloop
