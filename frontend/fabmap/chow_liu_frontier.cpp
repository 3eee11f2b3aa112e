// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/chow_liu_frontier.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace fabloop {
namespace {

constexpr std::size_t kMaxBlockSize = 512;
constexpr double kInTree = -std::numeric_limits<double>::infinity();
/// Below every mutual information, which may fall a little below zero by rounding.
constexpr double kNoLink = -1.0;

}  // namespace

ChowLiuFrontier::ChowLiuFrontier(const std::vector<Observation>& observations, const PairTables& tables)
    : observations_(observations), tables_(tables) {
  order_by_count();
  const std::size_t num_words = tables.num_words();
  mutual_information_.assign(num_words, kNoLink);
  parents_.assign(num_words, 0);
  both_.assign(num_words, 0);
  together_.assign(num_words, 0);
  num_outside_ = num_words;
  word_starts_.assign(num_words + 1, 0);
  for (Slot slot = 0; slot < num_words; ++slot) word_starts_[slot + 1] = word_starts_[slot] + tables.count(words_[slot]);
  word_images_.resize(word_starts_.back());
  std::vector<std::size_t> next(word_starts_.begin(), word_starts_.end() - 1);
  for (std::size_t image = 0; image < observations.size(); ++image) {
    for (const WordId word : observations[image].words) word_images_[next[slots_[word]]++] = static_cast<std::uint32_t>(image);
  }
  index_observations();
  remove(slots_[0]);
  add(0);
}

void ChowLiuFrontier::order_by_count() {
  words_.resize(tables_.num_words());
  std::iota(words_.begin(), words_.end(), WordId{0});
  std::stable_sort(words_.begin(), words_.end(), [&](WordId a, WordId b) { return tables_.count(a) < tables_.count(b); });
  slots_.resize(words_.size());
  block_of_.resize(words_.size());
  for (Slot slot = 0; slot < words_.size(); ++slot) {
    const ImageCount count = tables_.count(words_[slot]);
    if (blocks_.empty() || blocks_.back().count != count || blocks_.back().num_outside == kMaxBlockSize) {
      blocks_.push_back({slot, slot, count, kNoLink, 0, 0, slot});
    }
    ++blocks_.back().end;
    ++blocks_.back().num_outside;
    slots_[words_[slot]] = slot;
    block_of_[slot] = static_cast<std::uint32_t>(blocks_.size() - 1);
  }
}

/// Lists the words of each image that are still outside: the others need not be counted.
void ChowLiuFrontier::index_observations() {
  image_starts_.assign(1, 0);
  image_slots_.clear();
  for (const Observation& observation : observations_) {
    for (const WordId word : observation.words) {
      if (mutual_information_[slots_[word]] != kInTree) image_slots_.push_back(slots_[word]);
    }
    image_starts_.push_back(image_slots_.size());
  }
  num_indexed_ = num_outside_;
}

ChowLiuLink ChowLiuFrontier::take_best() {
  const Block* best = nullptr;
  for (const Block& block : blocks_) {
    if (block.num_outside > 0 && (best == nullptr || is_better(block.best, best->best))) best = &block;
  }
  const Slot slot = best->best;
  const ChowLiuLink link = {words_[slot], parents_[slot], both_[slot], mutual_information_[slot]};
  remove(slot);
  add(link.word);
  return link;
}

/// Compares all words outside with the one that has just joined.
void ChowLiuFrontier::add(WordId word) {
  constexpr double kWorthNewIndex = 0.875;
  if (static_cast<double>(num_outside_) < kWorthNewIndex * static_cast<double>(num_indexed_)) index_observations();
  // Where most words are seen together with it, a list of them costs more than looking at all.
  constexpr std::size_t kFewWords = 4;
  if (kFewWords * num_seen_beside(word) < num_outside_) {
    compare_those_together(word);
  } else {
    compare_all(word);
  }
}

std::size_t ChowLiuFrontier::num_seen_beside(WordId word) const {
  std::size_t sum = 0;
  for (const std::uint32_t image : images_of(word)) sum += image_starts_[image + 1] - image_starts_[image];
  return sum;
}

std::span<const std::uint32_t> ChowLiuFrontier::images_of(WordId word) const {
  const Slot slot = slots_[word];
  return {word_images_.data() + word_starts_[slot], word_starts_[slot + 1] - word_starts_[slot]};
}

std::span<const ChowLiuFrontier::Slot> ChowLiuFrontier::slots_in(std::uint32_t image) const {
  return {image_slots_.data() + image_starts_[image], image_starts_[image + 1] - image_starts_[image]};
}

void ChowLiuFrontier::compare_all(WordId word) {
  const ImageCount count = tables_.count(word);
  for (const std::uint32_t image : images_of(word)) {
    for (const Slot slot : slots_in(image)) ++together_[slot];
  }
  for (const Block& block : blocks_) {
    if (block.num_outside == 0) continue;
    const auto mutual_information = tables_.mutual_information(count, block.count);
    for (Slot slot = block.begin; slot < block.end; ++slot) {
      if (mutual_information_[slot] != kInTree) link_if_better(slot, word, together_[slot], mutual_information(together_[slot]));
    }
  }
  std::fill(together_.begin(), together_.end(), ImageCount{0});
}

void ChowLiuFrontier::compare_those_together(WordId word) {
  const ImageCount count = tables_.count(word);
  for (const std::uint32_t image : images_of(word)) {
    for (const Slot slot : slots_in(image)) {
      if (together_[slot]++ == 0) touched_.push_back(slot);
    }
  }
  // First those never seen together with the word: they are the ones where together_ is zero.
  for (Block& block : blocks_) {
    if (block.num_outside == 0 || count + block.count > tables_.num_images()) continue;
    improve_block(block, word, tables_.mutual_information(count, block.count)(0));
  }
  for (const Slot slot : touched_) {
    const ImageCount both = std::exchange(together_[slot], 0);
    if (mutual_information_[slot] == kInTree) continue;
    link_if_better(slot, word, both, tables_.mutual_information(count, blocks_[block_of_[slot]].count)(both));
  }
  touched_.clear();
}

void ChowLiuFrontier::link_if_better(Slot slot, WordId parent, ImageCount both, double mutual_information) {
  const double known = mutual_information_[slot];
  if (mutual_information < known || (mutual_information == known && parent > parents_[slot])) return;
  mutual_information_[slot] = mutual_information;
  parents_[slot] = parent;
  both_[slot] = both;
  Block& block = blocks_[block_of_[slot]];
  if (is_better(slot, block.best)) block.best = slot;
}

/// Offers a link of the same strength to all words of the block that are not seen together with the one added.
void ChowLiuFrontier::improve_block(Block& block, WordId added, double mutual_information) {
  if (mutual_information < block.weakest) return;
  if (mutual_information == block.weakest && added >= block.highest_parent) return;
  block.weakest = std::numeric_limits<double>::infinity();
  for (Slot slot = block.begin; slot < block.end; ++slot) {
    if (mutual_information_[slot] == kInTree) continue;
    if (together_[slot] == 0) link_if_better(slot, added, 0, mutual_information);
    if (mutual_information_[slot] < block.weakest) {
      block.weakest = mutual_information_[slot];
      block.highest_parent = parents_[slot];
    } else if (mutual_information_[slot] == block.weakest) {
      block.highest_parent = std::max(block.highest_parent, parents_[slot]);
    }
  }
}

void ChowLiuFrontier::remove(Slot slot) {
  mutual_information_[slot] = kInTree;
  --num_outside_;
  Block& block = blocks_[block_of_[slot]];
  --block.num_outside;
  if (block.best == slot) find_best(block);
}

void ChowLiuFrontier::find_best(Block& block) const {
  for (Slot slot = block.begin; slot < block.end; ++slot) {
    if (is_better(slot, block.best)) block.best = slot;
  }
}

bool ChowLiuFrontier::is_better(Slot a, Slot b) const {
  if (mutual_information_[a] != mutual_information_[b]) return mutual_information_[a] > mutual_information_[b];
  return words_[a] < words_[b];
}

}  // namespace fabloop
