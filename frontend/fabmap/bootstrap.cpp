// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// Linear between the order statistics.
double quantile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - std::floor(position)) * (sorted[above] - sorted[below]);
}

}  // namespace

std::vector<std::optional<Interval>> bootstrap_intervals(std::size_t num_items, const ResampledFigures& figures,
                                                         const BootstrapOptions& options) {
  if (!(options.confidence > 0.0 && options.confidence < 1.0)) {
    throw InputError("the confidence of a bootstrap interval must be between 0 and 1");
  }
  std::mt19937_64 random(options.seed);
  std::vector<std::size_t> sample(num_items);
  std::vector<std::vector<double>> values;
  for (std::size_t i = 0; num_items > 0 && i < options.num_resamples; ++i) {
    for (std::size_t& item : sample) item = static_cast<std::size_t>(random() % num_items);
    const auto found = figures(sample);
    values.resize(std::max(values.size(), found.size()));
    for (std::size_t f = 0; f < found.size(); ++f) {
      if (found[f]) values[f].push_back(*found[f]);
    }
  }
  std::vector<std::optional<Interval>> intervals(values.size());
  for (std::size_t f = 0; f < values.size(); ++f) {
    if (2 * values[f].size() < options.num_resamples) continue;
    std::sort(values[f].begin(), values[f].end());
    const double outside = 0.5 * (1.0 - options.confidence);
    intervals[f] = Interval{quantile(values[f], outside), quantile(values[f], 1.0 - outside)};
  }
  return intervals;
}

}  // namespace fabloop
