// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "frontend/fabmap/model.h"

namespace fabloop::testing_support {

inline constexpr std::size_t kNumWords = 60;

/// Sixty independent words, each in a tenth of all images.
inline Model model_of_words() {
  Model model;
  model.tree.nodes.assign(kNumWords, {std::nullopt, 0.1, 0.1, 0.1});
  return model;
}

}  // namespace fabloop::testing_support
