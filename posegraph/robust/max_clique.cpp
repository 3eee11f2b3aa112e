// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/max_clique.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

namespace fabloop {
namespace {

using Word = BitGraph::Word;
using Bits = std::vector<Word>;

std::size_t count(const Bits& bits) {
  return std::accumulate(bits.begin(), bits.end(), std::size_t{0},
                         [](std::size_t sum, Word word) { return sum + static_cast<std::size_t>(std::popcount(word)); });
}

/// The lowest member, which is taken out. The set must not be empty.
std::size_t take_first(Bits& bits, std::size_t& word) {
  while (bits[word] == 0) ++word;
  const auto bit = static_cast<std::size_t>(std::countr_zero(bits[word]));
  bits[word] &= bits[word] - 1;
  return word * 64 + bit;
}

/// Vertices by degeneracy: the one of least degree is removed again and again, and stands last. Colours are few in this order.
std::vector<std::size_t> degeneracy_order(const BitGraph& graph) {
  const std::size_t size = graph.size();
  std::vector<std::size_t> degree(size);
  for (std::size_t v = 0; v < size; ++v) degree[v] = graph.degree(v);
  std::vector<bool> removed(size, false);
  std::vector<std::size_t> order(size);
  for (std::size_t place = size; place-- > 0;) {
    std::size_t least = size;
    for (std::size_t v = 0; v < size; ++v) {
      if (!removed[v] && (least == size || degree[v] < degree[least])) least = v;
    }
    removed[least] = true;
    order[place] = least;
    for (std::size_t v = 0; v < size; ++v) {
      if (!removed[v] && graph.are_joined(least, v)) --degree[v];
    }
  }
  return order;
}

BitGraph reordered(const BitGraph& graph, const std::vector<std::size_t>& order) {
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  BitGraph result(graph.size());
  for (std::size_t a = 0; a < graph.size(); ++a) {
    for (std::size_t w = 0; w < graph.num_words(); ++w) {
      for (Word word = graph.row(a)[w]; word != 0; word &= word - 1) {
        const std::size_t b = w * 64 + static_cast<std::size_t>(std::countr_zero(word));
        if (a < b) result.join(place[a], place[b]);
      }
    }
  }
  return result;
}

/// Grown from each of the first vertices: always the candidate that leaves most candidates.
std::vector<std::size_t> greedy_clique(const BitGraph& graph) {
  constexpr std::size_t kNumStarts = 3;
  std::vector<std::size_t> best;
  Bits candidates(graph.num_words());
  Bits left(graph.num_words());
  for (std::size_t start = 0; start < std::min(kNumStarts, graph.size()); ++start) {
    std::vector<std::size_t> clique = {start};
    std::copy_n(graph.row(start), graph.num_words(), candidates.begin());
    for (std::size_t num_left = count(candidates); num_left > 0; num_left = count(candidates)) {
      std::size_t chosen = graph.size();
      std::size_t most = 0;
      Bits rest = candidates;
      for (std::size_t word = 0, k = 0; k < num_left; ++k) {
        const std::size_t v = take_first(rest, word);
        std::size_t kept = 0;
        for (std::size_t w = 0; w < candidates.size(); ++w) {
          kept += static_cast<std::size_t>(std::popcount(candidates[w] & graph.row(v)[w]));
        }
        if (chosen == graph.size() || kept > most) {
          chosen = v;
          most = kept;
        }
        if (kept + 1 == num_left) break;
      }
      clique.push_back(chosen);
      for (std::size_t w = 0; w < candidates.size(); ++w) candidates[w] &= graph.row(chosen)[w];
    }
    if (clique.size() > best.size()) best = clique;
  }
  return best;
}

/// The recursion of the search. Vertices are those of the reordered graph.
class Search {
 public:
  Search(const BitGraph& graph, std::size_t max_work, std::vector<std::size_t> best)
      : graph_(graph), max_work_(max_work), best_(std::move(best)) {}

  void run() {
    Bits all(graph_.num_words(), 0);
    for (std::size_t v = 0; v < graph_.size(); ++v) all[v / 64] |= Word{1} << (v % 64);
    expand(std::move(all));
  }

  bool is_proven() const { return !stopped_; }
  std::size_t work() const { return work_; }
  const std::vector<std::size_t>& best() const { return best_; }

 private:
  /// The candidates in the order of their colours that could lead to a larger clique, each with its colour: no clique among
  /// those up to it has more members.
  struct Coloured {
    std::vector<std::size_t> vertices, colours;
  };

  Coloured colour(const Bits& candidates) {
    Coloured result;
    const std::size_t needed = best_.size() < current_.size() ? 0 : best_.size() - current_.size();
    Bits uncoloured = candidates;
    for (std::size_t colour = 1, left = count(candidates); left > 0; ++colour) {
      Bits open = uncoloured;
      for (std::size_t word = 0; word < open.size(); ++word) {
        while (open[word] != 0) {
          std::size_t at = word;
          const std::size_t v = take_first(open, at);
          uncoloured[v / 64] &= ~(Word{1} << (v % 64));
          for (std::size_t w = word; w < open.size(); ++w) open[w] &= ~graph_.row(v)[w];
          --left;
          work_ += open.size() - word;
          if (colour <= needed) continue;
          result.vertices.push_back(v);
          result.colours.push_back(colour);
        }
      }
    }
    return result;
  }

  void expand(Bits candidates) {
    const Coloured coloured = colour(candidates);
    for (std::size_t k = coloured.vertices.size(); k-- > 0;) {
      if (current_.size() + coloured.colours[k] <= best_.size()) return;
      if (work_ >= max_work_) {
        stopped_ = true;
        return;
      }
      const std::size_t v = coloured.vertices[k];
      current_.push_back(v);
      Bits next(candidates.size());
      for (std::size_t w = 0; w < next.size(); ++w) next[w] = candidates[w] & graph_.row(v)[w];
      if (count(next) > 0) {
        expand(std::move(next));
      } else if (current_.size() > best_.size()) {
        best_ = current_;
      }
      current_.pop_back();
      if (stopped_) return;
      candidates[v / 64] &= ~(Word{1} << (v % 64));
    }
  }

  const BitGraph& graph_;
  std::size_t max_work_, work_ = 0;
  std::vector<std::size_t> current_, best_;
  bool stopped_ = false;
};

}  // namespace

BitGraph::BitGraph(std::size_t size) : size_(size), num_words_((size + 63) / 64), bits_(size * num_words_, 0) {}

void BitGraph::join(std::size_t a, std::size_t b) {
  assert(a != b && a < size_ && b < size_);
  bits_[a * num_words_ + b / 64] |= Word{1} << (b % 64);
  bits_[b * num_words_ + a / 64] |= Word{1} << (a % 64);
}

std::size_t BitGraph::degree(std::size_t a) const {
  std::size_t result = 0;
  for (std::size_t w = 0; w < num_words_; ++w) result += static_cast<std::size_t>(std::popcount(row(a)[w]));
  return result;
}

std::size_t BitGraph::add_vertex() {
  if (size_ == num_words_ * 64) {
    // Room for as many again, so that growing one by one costs no more than having known the size.
    const std::size_t num_words = std::max<std::size_t>(1, 2 * num_words_);
    std::vector<Word> bits(size_ * num_words, 0);
    for (std::size_t v = 0; v < size_; ++v)
      std::copy_n(row(v), num_words_, bits.begin() + static_cast<std::ptrdiff_t>(v * num_words));
    num_words_ = num_words;
    bits_ = std::move(bits);
  }
  bits_.resize(bits_.size() + num_words_, 0);
  return size_++;
}

Clique max_clique(const BitGraph& graph, const MaxCliqueOptions& options) {
  const std::vector<std::size_t> order = degeneracy_order(graph);
  const BitGraph in_order = reordered(graph, order);
  std::vector<std::size_t> best = greedy_clique(in_order);
  if (options.known.size() >= best.size()) {
    std::vector<std::size_t> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
    best.clear();
    for (const std::size_t v : options.known) best.push_back(place[v]);
  }
  Search search(in_order, options.max_work, std::move(best));
  search.run();
  Clique clique;
  for (const std::size_t v : search.best()) clique.vertices.push_back(order[v]);
  std::sort(clique.vertices.begin(), clique.vertices.end());
  clique.is_proven = search.is_proven();
  clique.work = search.work();
  return clique;
}

}  // namespace fabloop
