// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop::testing_support {

/// Counts successes of pose estimators: a rotation within 1 degree and a translation within 5 % of `length`.
class PoseTally {
 public:
  explicit PoseTally(double length) : length_(length) {}

  void add(const std::optional<Pose>& found, const Pose& truth, int draws) {
    draws_ += draws;
    ++count_;
    if (!found) return;
    const double rotation_deg = deg_from_rad(found->rotation.angularDistance(truth.rotation));
    const double translation = (found->translation - truth.translation).norm() / length_;
    rotations_deg_.push_back(rotation_deg);
    translations_.push_back(translation);
    num_right_ += rotation_deg < 1.0 && translation < 0.05;
  }

  void report(benchmark::State& state) const {
    state.counters["success_percent"] = 100.0 * num_right_ / count_;
    state.counters["trials"] = count_;
    state.counters["median_rotation_deg"] = median(rotations_deg_);
    state.counters["median_translation_percent"] = 100.0 * median(translations_);
    state.counters["draws"] = draws_ / count_;
  }

 private:
  static double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  double length_;
  double num_right_ = 0, count_ = 0, draws_ = 0;
  std::vector<double> rotations_deg_, translations_;
};

}  // namespace fabloop::testing_support
