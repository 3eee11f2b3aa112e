// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/five_point.h"

#include <cmath>
#include <cstdint>

#include "verification/pose/five_point_constraints.h"
#include "verification/pose/polynomial_roots.h"

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
namespace fabloop {
namespace {

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
