// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/held_out.h"

#include <algorithm>

namespace fabloop {
namespace {

constexpr std::size_t kNumBlocks = 20;
constexpr std::size_t kHoldOutEvery = 5;
constexpr std::size_t kMinHeldOutImages = 10;  // two held out, at least

bool is_held_out(std::size_t image, std::size_t num_images) {
  return image * std::min(kNumBlocks, num_images) / num_images % kHoldOutEvery == kHoldOutEvery / 2;
}

}  // namespace

std::optional<HeldOut> hold_out(const std::vector<Observation>& observations, std::size_t num_words,
                                const ChowLiuOptions& options) {
  if (observations.size() < kMinHeldOutImages) return std::nullopt;
  HeldOut result;
  std::vector<Observation> others;
  for (std::size_t image = 0; image < observations.size(); ++image) {
    (is_held_out(image, observations.size()) ? result.images : others).push_back(observations[image]);
  }
  result.tree = train_chow_liu_tree(others, num_words, options).tree;
  return result;
}

}  // namespace fabloop
