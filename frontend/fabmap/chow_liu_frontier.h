// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/pair_tables.h"

namespace fabloop {

/// A word that joins the tree, and the one it hangs on.
struct ChowLiuLink {
  WordId word = 0;
  WordId parent = 0;
  ImageCount both = 0;  ///< Images that show both.
  double mutual_information = 0.0;
};

/// The words outside a maximum spanning tree that grows from word 0, each with its best link into it (Prim 1957).
///
/// When a word joins, only those seen together with it are compared one by one. For all others the mutual information
/// depends on how often each is seen alone; so words stand in the order of their counts, in blocks of one count that know
/// the weakest link in them, and a block is looked into only if a word never seen together with it could improve that one.
/// Blocks know their strongest link too, so that finding the best of all takes a look at each block. The tree is the same
/// as if every pair were compared.
class ChowLiuFrontier {
 public:
  /// Both must live as long as this.
  ChowLiuFrontier(const std::vector<Observation>& observations, const PairTables& tables);

  bool empty() const { return num_outside_ == 0; }

  /// Takes out the word with the best link; ties go to the lower word, then to the lower parent.
  ChowLiuLink take_best();

 private:
  /// Where a word stands in the order of counts.
  using Slot = std::uint32_t;

  struct Block {
    Slot begin = 0, end = 0;
    ImageCount count = 0;         ///< Of each of its words.
    double weakest = 0.0;         ///< No link is weaker.
    WordId highest_parent = 0;    ///< No link that weak has a higher parent.
    std::size_t num_outside = 0;  ///< Words not yet in the tree.
    Slot best = 0;                ///< The best link, where there is one.
  };

  void order_by_count();
  void index_observations();
  void add(WordId word);
  void compare_all(WordId word);
  void compare_those_together(WordId word);
  std::size_t num_seen_beside(WordId word) const;
  std::span<const std::uint32_t> images_of(WordId word) const;
  std::span<const Slot> slots_in(std::uint32_t image) const;
  void link_if_better(Slot slot, WordId parent, ImageCount both, double mutual_information);
  void improve_block(Block& block, WordId added, double mutual_information);
  void find_best(Block& block) const;
  void remove(Slot slot);
  bool is_better(Slot a, Slot b) const;

  const std::vector<Observation>& observations_;
  const PairTables& tables_;
  std::size_t num_outside_ = 0;
  std::size_t num_indexed_ = 0;  ///< Words outside when the index was last made.

  std::vector<WordId> words_;               ///< By slot.
  std::vector<Slot> slots_;                 ///< By word.
  std::vector<double> mutual_information_;  ///< By slot, of the best link; kInTree once the word has joined.
  std::vector<WordId> parents_;             ///< By slot, of the best link.
  std::vector<ImageCount> both_;            ///< By slot, of the best link.
  std::vector<std::uint32_t> block_of_;     ///< By slot.
  std::vector<Block> blocks_;

  std::vector<std::size_t> image_starts_;   ///< Of each image in image_slots_, and the end of the last.
  std::vector<Slot> image_slots_;           ///< The words outside that each image shows.
  std::vector<std::size_t> word_starts_;    ///< Of each slot in word_images_, and the end of the last.
  std::vector<std::uint32_t> word_images_;  ///< The images that show each word.
  std::vector<ImageCount> together_;        ///< By slot: images shared with the word added. Zero between calls.
  std::vector<Slot> touched_;               ///< Slots where together_ is not zero.
};

}  // namespace fabloop
