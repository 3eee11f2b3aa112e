// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace fabloop {

struct Interval {
  double low = 0.0, high = 0.0;
};

struct BootstrapOptions {
  std::size_t num_resamples = 1000;  ///< More for steadier ends. 0: no intervals.
  double confidence = 0.95;          ///< Share of the resamples inside the interval.
  std::uint64_t seed = 1;
};

/// Some figures of a sample, given as positions of the items in it (with repeats); none where a figure is not defined.
using ResampledFigures = std::function<std::vector<std::optional<double>>(std::span<const std::size_t> sample)>;

/// The intervals of figures over `num_items` independent items (percentile method; Efron and Tibshirani 1993, ch. 13): the items
/// are drawn anew with replacement, and the middle of the figures' distribution is kept. A figure's interval is none where it was
/// defined for less than half of the resamples. Throws InputError for a confidence outside (0, 1).
std::vector<std::optional<Interval>> bootstrap_intervals(std::size_t num_items, const ResampledFigures& figures,
                                                         const BootstrapOptions& options = {});

}  // namespace fabloop
