// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "verification/pose/lanes.h"

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
namespace fabloop {

/// Polynomials in z, lowest power first.
template <int kSize>
struct Powers {
  Lanes c[kSize];
};

template <int kA, int kB>
FABLOOP_INLINE void add_product(const Powers<kA>& a, const Powers<kB>& b, Powers<kA + kB - 1>& sum) {
  for (int i = 0; i < kA; ++i) {
    for (int j = 0; j < kB; ++j) sum.c[i + j] += a.c[i] * b.c[j];
  }
}

template <int kA, int kB>
FABLOOP_INLINE void subtract_product(const Powers<kA>& a, const Powers<kB>& b, Powers<kA + kB - 1>& sum) {
  for (int i = 0; i < kA; ++i) {
    for (int j = 0; j < kB; ++j) sum.c[i + j] -= a.c[i] * b.c[j];
  }
}

constexpr int kDegree = 10;
constexpr int kNumNodes = 49;  ///< Grid over [-1, 1], and as many over the reciprocals.

/// Where to look for roots: the tangents of equal angles.
struct Nodes {
  double at[kNumNodes];
};

inline Nodes make_nodes() {
  constexpr double kQuarterPi = 0.78539816339744831;
  Nodes nodes;
  for (int k = 0; k < kNumNodes; ++k) nodes.at[k] = std::tan(kQuarterPi * (2.0 * k / (kNumNodes - 1) - 1.0));
  return nodes;
}

inline const Nodes kNodes = make_nodes();

/// An interval in which the polynomial of one lane changes its sign.
struct Bracket {
  double low, high, at_low, at_high;
  std::uint8_t lane;
  bool reciprocal;  ///< In 1 / z.
};

constexpr int kMaxBrackets = static_cast<int>(kLanes * kMaxFivePointSolutions);

struct Brackets {
  Bracket items[kMaxBrackets + kLanes];
  int count = 0;
  int of_lane[kLanes] = {};
};

/// A polynomial of one lane with its slope, at one place.
struct ValueAndSlope {
  double value, slope;
};

FABLOOP_INLINE void value_and_slope(const Powers<kDegree + 1>& polynomial, bool reciprocal, std::size_t lane, double at,
                                    ValueAndSlope& result) {
  result = {polynomial.c[reciprocal ? 0 : kDegree][lane], 0};
  for (int i = 1; i <= kDegree; ++i) {
    result.slope = result.slope * at + result.value;
    result.value = result.value * at + polynomial.c[reciprocal ? i : kDegree - i][lane];
  }
}

FABLOOP_INLINE void add_bracket(const Bracket& bracket, Brackets& brackets) {
  if (brackets.of_lane[bracket.lane] == static_cast<int>(kMaxFivePointSolutions)) return;
  brackets.items[brackets.count++] = bracket;
  ++brackets.of_lane[bracket.lane];
}

/// Two roots between neighbouring nodes leave no change of sign, but an extremum that reaches across zero.
FABLOOP_INLINE void bracket_close_roots(const Powers<kDegree + 1>& polynomial, const Bracket& interval, double slope_low,
                                        double slope_high, Brackets& brackets) {
  double low = interval.low, high = interval.high;
  constexpr int kSteps = 2;
  for (int step = 0; step < kSteps; ++step) {
    const double extremum = low + (high - low) * slope_low / (slope_low - slope_high);
    ValueAndSlope there;
    value_and_slope(polynomial, interval.reciprocal, interval.lane, extremum, there);
    if ((there.value < 0) != (interval.at_low < 0)) {
      add_bracket({interval.low, extremum, interval.at_low, there.value, interval.lane, interval.reciprocal}, brackets);
      add_bracket({extremum, interval.high, there.value, interval.at_high, interval.lane, interval.reciprocal}, brackets);
      return;
    }
    const bool before = (there.slope < 0) == (slope_low < 0);
    (before ? low : high) = extremum;
    (before ? slope_low : slope_high) = there.slope;
  }
}

FABLOOP_INLINE void bracket_roots(const Powers<kDegree + 1>& polynomial, bool reciprocal, Brackets& brackets) {
  alignas(32) double values[kNumNodes][kLanes];
  alignas(32) double slopes[kNumNodes][kLanes];
  for (int k = 0; k < kNumNodes; ++k) {
    const double at = kNodes.at[k];
    Lanes value = polynomial.c[reciprocal ? 0 : kDegree];
    Lanes slope = {};
    for (int i = 1; i <= kDegree; ++i) {
      slope = slope * at + value;
      value = value * at + polynomial.c[reciprocal ? i : kDegree - i];
    }
    *reinterpret_cast<Lanes*>(values[k]) = value;
    *reinterpret_cast<Lanes*>(slopes[k]) = slope;
  }
  for (int k = 0; k + 1 < kNumNodes; ++k) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double a = values[k][l], b = values[k + 1][l];
      const Bracket interval{kNodes.at[k], kNodes.at[k + 1], a, b, static_cast<std::uint8_t>(l), reciprocal};
      if ((a < 0) != (b < 0)) {
        add_bracket(interval, brackets);
      } else if (a * slopes[k][l] < 0 && b * slopes[k + 1][l] > 0) {
        bracket_close_roots(polynomial, interval, slopes[k][l], slopes[k + 1][l], brackets);
      }
    }
  }
}

/// Newton's method from the secant's root, kept inside the bracket.
FABLOOP_INLINE void refine_roots(const Powers<kDegree + 1>& z, const Bracket* brackets, Lanes& root) {
  Lanes c[kDegree + 1];  // highest power first
  Lanes low, high, at_low, at_high;
  for (std::size_t g = 0; g < kLanes; ++g) {
    const Bracket& bracket = brackets[g];
    low[g] = bracket.low;
    high[g] = bracket.high;
    at_low[g] = bracket.at_low;
    at_high[g] = bracket.at_high;
    for (int i = 0; i <= kDegree; ++i) c[i][g] = z.c[bracket.reciprocal ? i : kDegree - i][bracket.lane];
  }
  root = (low * at_high - high * at_low) / (at_high - at_low);
  const LaneMask negative_low = at_low < Lanes{};
  constexpr int kSteps = 6;
  for (int step = 0; step < kSteps; ++step) {
    Lanes value = c[0], slope = {};
    for (int i = 1; i <= kDegree; ++i) {
      slope = slope * root + value;
      value = value * root + c[i];
    }
    const LaneMask on_low_side = (value < Lanes{}) == negative_low;
    low = on_low_side ? root : low;
    high = on_low_side ? high : root;
    const Lanes next = root - value / slope;
    const LaneMask inside = (next >= low) & (next <= high);
    root = inside ? next : 0.5 * (low + high);
  }
}

}  // namespace fabloop
// NOLINTEND(cppcoreguidelines-pro-bounds-*)
