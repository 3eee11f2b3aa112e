// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "verification/pose/lanes.h"

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
namespace fabloop {

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

}  // namespace fabloop
// NOLINTEND(cppcoreguidelines-pro-bounds-*)
