// SPDX-License-Identifier: BSD-3-Clause
// No Eigen here: functions of this unit are compiled for several processors, and inline functions of a header would be too.
#include "verification/five_point.h"

#include <cmath>
#include <cstdint>

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
#define FABLOOP_INLINE static inline __attribute__((always_inline))

namespace fabloop {
namespace {

constexpr std::size_t kLanes = kFivePointLanes;

/// One double a lane; GCC and Clang map it to whatever vectors the processor has.
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef std::int64_t LaneMask __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

// Polynomials in (x, y, z) of the degrees that occur, by their coefficients.
struct Linear {  // x y z 1
  Lanes c[4];
};
struct Quadratic {  // xx xy yy xz yz x y zz z 1
  Lanes c[10];
};
/// Monomials of degree three in the order of Nister 2004, section 3.2: x^3 y^3 x^2y xy^2 x^2z x^2 y^2z y^2 xyz xy | xz^2 xz x
/// | yz^2 yz y | z^3 z^2 z 1.
constexpr int kNumCubic = 20;

/// Which cubic monomial is (quadratic monomial) * (x, y, z, 1).
constexpr int kProduct[10][4] = {
    {0, 2, 4, 5},      // xx: xxx, xxy, xxz, xx
    {2, 3, 8, 9},      // xy: xxy, xyy, xyz, xy
    {3, 1, 6, 7},      // yy: xyy, yyy, yyz, yy
    {4, 8, 10, 11},    // xz: xxz, xyz, xzz, xz
    {8, 6, 13, 14},    // yz: xyz, yyz, yzz, yz
    {5, 9, 11, 12},    // x:  xx, xy, xz, x
    {9, 7, 14, 15},    // y:  xy, yy, yz, y
    {10, 13, 16, 17},  // zz: xzz, yzz, zzz, zz
    {11, 14, 17, 18},  // z:  xz, yz, zz, z
    {12, 15, 18, 19},  // 1:  x, y, z, 1
};

FABLOOP_INLINE void add_product(const Linear& a, const Linear& b, Quadratic& sum) {
  sum.c[0] += a.c[0] * b.c[0];
  sum.c[1] += a.c[0] * b.c[1] + a.c[1] * b.c[0];
  sum.c[2] += a.c[1] * b.c[1];
  sum.c[3] += a.c[0] * b.c[2] + a.c[2] * b.c[0];
  sum.c[4] += a.c[1] * b.c[2] + a.c[2] * b.c[1];
  sum.c[5] += a.c[0] * b.c[3] + a.c[3] * b.c[0];
  sum.c[6] += a.c[1] * b.c[3] + a.c[3] * b.c[1];
  sum.c[7] += a.c[2] * b.c[2];
  sum.c[8] += a.c[2] * b.c[3] + a.c[3] * b.c[2];
  sum.c[9] += a.c[3] * b.c[3];
}

FABLOOP_INLINE void subtract_product(const Linear& a, const Linear& b, Quadratic& sum) {
  Linear negative;
  for (int i = 0; i < 4; ++i) negative.c[i] = -a.c[i];
  add_product(negative, b, sum);
}

FABLOOP_INLINE void add_product(const Quadratic& a, const Linear& b, Lanes* sum) {
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 4; ++j) sum[kProduct[i][j]] += a.c[i] * b.c[j];
  }
}

/// An orthonormal basis of the matrices that satisfy the five epipolar constraints, by Householder reflections of the 9x5
/// matrix of constraints: E = x X + y Y + z Z + W.
FABLOOP_INLINE void null_space(const FivePointSamples& samples, Linear* essential) {
  Lanes a[5][9];
  for (int i = 0; i < 5; ++i) {
    Lanes q[3], m[3];
    for (int k = 0; k < 3; ++k) {
      q[k] = *reinterpret_cast<const Lanes*>(samples.query[i][k].data());
      m[k] = *reinterpret_cast<const Lanes*>(samples.match[i][k].data());
    }
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a[i][3 * r + c] = m[r] * q[c];
    }
  }
  Lanes scale[5];
  for (int k = 0; k < 5; ++k) {
    Lanes squared = {};
    for (int r = k; r < 9; ++r) squared += a[k][r] * a[k][r];
    Lanes norm;
    for (std::size_t l = 0; l < kLanes; ++l) norm[l] = std::sqrt(squared[l]);
    norm = a[k][k] < Lanes{} ? -norm : norm;
    a[k][k] += norm;
    scale[k] = 1.0 / (norm * a[k][k] + 1e-300);
    for (int j = k + 1; j < 5; ++j) {
      Lanes dot = {};
      for (int r = k; r < 9; ++r) dot += a[k][r] * a[j][r];
      dot *= scale[k];
      for (int r = k; r < 9; ++r) a[j][r] -= dot * a[k][r];
    }
  }
  for (int v = 0; v < 4; ++v) {
    Lanes column[9] = {};
    column[5 + v] += 1.0;
    for (int k = 4; k >= 0; --k) {
      Lanes dot = {};
      for (int r = k; r < 9; ++r) dot += a[k][r] * column[r];
      dot *= scale[k];
      for (int r = k; r < 9; ++r) column[r] -= dot * a[k][r];
    }
    for (int r = 0; r < 9; ++r) essential[r].c[v] = column[r];
  }
}

/// det E = 0 and 2 E E^T E - tr(E E^T) E = 0 as ten cubic polynomials (Nister 2004, eq. 8 and 9).
FABLOOP_INLINE void constraints(const Linear* e, Lanes (*rows)[kNumCubic]) {
  Quadratic square[3][3] = {};  // E E^T
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) add_product(e[3 * i + k], e[3 * j + k], square[i][j]);
    }
  }
  for (int k = 0; k < 10; ++k) {
    const Lanes half_trace = 0.5 * (square[0][0].c[k] + square[1][1].c[k] + square[2][2].c[k]);
    for (int i = 0; i < 3; ++i) square[i][i].c[k] -= half_trace;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Lanes* row = rows[3 * i + j];
      for (int k = 0; k < 3; ++k) add_product(i <= k ? square[i][k] : square[k][i], e[3 * k + j], row);
    }
  }
  for (int j = 0; j < 3; ++j) {
    const int a = (j + 1) % 3, b = (j + 2) % 3;
    Quadratic cofactor = {};
    add_product(e[3 + a], e[6 + b], cofactor);
    subtract_product(e[3 + b], e[6 + a], cofactor);
    add_product(cofactor, e[j], rows[9]);
  }
}

/// Brings the left half of rows 4..9 to the identity; their right halves are what Nister's rows e to j hold.
FABLOOP_INLINE void eliminate(Lanes (*rows)[kNumCubic]) {
  for (int k = 0; k < 10; ++k) {
    const Lanes inverse = 1.0 / rows[k][k];
    for (int c = k + 1; c < kNumCubic; ++c) rows[k][c] *= inverse;
    for (int r = k + 1; r < 10; ++r) {
      const Lanes factor = rows[r][k];
      for (int c = k + 1; c < kNumCubic; ++c) rows[r][c] -= factor * rows[k][c];
    }
  }
  for (int k = 9; k > 4; --k) {
    for (int r = 4; r < k; ++r) {
      const Lanes factor = rows[r][k];
      for (int c = 10; c < kNumCubic; ++c) rows[r][c] -= factor * rows[k][c];
    }
  }
}

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

/// x(z) b.x + y(z) b.y + b.one = 0: one of Nister's rows k, l, m (eq. 13 to 15).
struct BRow {
  Powers<4> x, y;
  Powers<5> one;
};

FABLOOP_INLINE void b_row(const Lanes* with_z, const Lanes* without_z, BRow& row) {
  const Lanes* e = with_z + 10;
  const Lanes* f = without_z + 10;
  row.x = {{e[2], e[1] - f[2], e[0] - f[1], -f[0]}};
  row.y = {{e[5], e[4] - f[5], e[3] - f[4], -f[3]}};
  row.one = {{e[9], e[8] - f[9], e[7] - f[8], e[6] - f[7], -f[6]}};
}

/// The three minors that give x and y (eq. 27) and the polynomial whose roots are z (eq. 23 to 28).
struct Solved {
  Powers<8> x, y;
  Powers<7> one;
  Powers<11> z;
};

FABLOOP_INLINE void solve_for_z(const Lanes (*rows)[kNumCubic], Solved& solved) {
  BRow k, l, m;
  b_row(rows[4], rows[5], k);
  b_row(rows[6], rows[7], l);
  b_row(rows[8], rows[9], m);
  solved = {};
  add_product(k.y, l.one, solved.x);
  subtract_product(l.y, k.one, solved.x);
  add_product(l.x, k.one, solved.y);
  subtract_product(k.x, l.one, solved.y);
  add_product(k.x, l.y, solved.one);
  subtract_product(k.y, l.x, solved.one);
  add_product(solved.x, m.x, solved.z);
  add_product(solved.y, m.y, solved.z);
  add_product(solved.one, m.one, solved.z);
}

constexpr int kDegree = 10;
constexpr int kNumNodes = 49;  ///< Grid over [-1, 1], and as many over the reciprocals.

/// Where to look for roots: the tangents of equal angles.
struct Nodes {
  double at[kNumNodes];
};

Nodes make_nodes() {
  constexpr double kQuarterPi = 0.78539816339744831;
  Nodes nodes;
  for (int k = 0; k < kNumNodes; ++k) nodes.at[k] = std::tan(kQuarterPi * (2.0 * k / (kNumNodes - 1) - 1.0));
  return nodes;
}

const Nodes kNodes = make_nodes();

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

template <int kSize>
FABLOOP_INLINE void evaluate(const Lanes (&c)[kSize], const Lanes& at, Lanes& value) {
  value = c[kSize - 1];
  for (int i = kSize - 2; i >= 0; --i) value = value * at + c[i];
}

/// The essential matrices of four roots.
FABLOOP_INLINE void essentials_of(const Linear* basis, const Solved& solved, const Bracket* brackets, const Lanes& root,
                                  Lanes (&essential)[9]) {
  Lanes x[8], y[8], one[7], b[9][4];
  Lanes flip;
  for (std::size_t g = 0; g < kLanes; ++g) {
    const std::uint8_t lane = brackets[g].lane;
    const bool r = brackets[g].reciprocal;
    flip[g] = r ? 1.0 : 0.0;
    for (int i = 0; i < 8; ++i) x[i][g] = solved.x.c[r ? 7 - i : i][lane];
    for (int i = 0; i < 8; ++i) y[i][g] = solved.y.c[r ? 7 - i : i][lane];
    for (int i = 0; i < 7; ++i) one[i][g] = solved.one.c[r ? 6 - i : i][lane];
    for (int i = 0; i < 9; ++i) {
      for (int k = 0; k < 4; ++k) b[i][k][g] = basis[i].c[k][lane];
    }
  }
  // (x, y, z, 1) times the minor `one`, and in the reciprocal case times 1/z to the power of seven.
  Lanes at_x, at_y, minor;
  evaluate(x, root, at_x);
  evaluate(y, root, at_y);
  evaluate(one, root, minor);
  const LaneMask is_reciprocal = flip > 0.5 + Lanes{};
  const Lanes at_z = is_reciprocal ? minor : minor * root;
  const Lanes at_one = is_reciprocal ? minor * root : minor;
  for (int i = 0; i < 9; ++i) essential[i] = at_x * b[i][0] + at_y * b[i][1] + at_z * b[i][2] + at_one * b[i][3];
}

FABLOOP_INLINE void solve(const FivePointSamples& samples, FivePointSolutions& solutions) {
  Linear basis[9];
  null_space(samples, basis);
  Lanes rows[10][kNumCubic] = {};
  constraints(basis, rows);
  eliminate(rows);
  Solved solved;
  solve_for_z(rows, solved);
  Brackets brackets;
  bracket_roots(solved.z, false, brackets);
  bracket_roots(solved.z, true, brackets);
  solutions.count = {};
  if (brackets.count == 0) return;
  const int padded = (brackets.count + static_cast<int>(kLanes) - 1) / static_cast<int>(kLanes) * static_cast<int>(kLanes);
  for (int i = brackets.count; i < padded; ++i) brackets.items[i] = brackets.items[brackets.count - 1];
  for (int first = 0; first < brackets.count; first += static_cast<int>(kLanes)) {
    Lanes root;
    refine_roots(solved.z, brackets.items + first, root);
    Lanes essential[9];
    essentials_of(basis, solved, brackets.items + first, root, essential);
    for (int g = 0; g < static_cast<int>(kLanes) && first + g < brackets.count; ++g) {
      const std::uint8_t lane = brackets.items[first + g].lane;
      auto& out = solutions.essentials[lane][solutions.count[lane]];
      double squared_norm = 0;
      for (std::size_t i = 0; i < 9; ++i) {
        out[i] = essential[i][g];
        squared_norm += out[i] * out[i];
      }
      if (!(squared_norm > 0) || !(squared_norm < 1e300)) continue;
      const double inverse_norm = 1.0 / std::sqrt(squared_norm);
      for (double& value : out) value *= inverse_norm;
      ++solutions.count[lane];
    }
  }
}

void solve_baseline(const FivePointSamples& samples, FivePointSolutions& solutions) { solve(samples, solutions); }

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void solve_avx2(const FivePointSamples& samples, FivePointSolutions& solutions) {
  solve(samples, solutions);
}
#endif

auto fastest_solver() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return solve_avx2;
#endif
  return solve_baseline;
}

}  // namespace

FivePointSolutions five_point(const FivePointSamples& samples) {
  static const auto solver = fastest_solver();
  FivePointSolutions solutions;
  solver(samples, solutions);
  return solutions;
}

}  // namespace fabloop
// NOLINTEND(cppcoreguidelines-pro-bounds-*)
