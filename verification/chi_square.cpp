// SPDX-License-Identifier: BSD-3-Clause
#include "verification/chi_square.h"

#include <cassert>
#include <cmath>

namespace fabloop {
namespace {

/// P(X > x). Q_{k+2}(x) = Q_k(x) + (x/2)^{k/2} e^{-x/2} / Gamma(k/2 + 1); Abramowitz & Stegun 26.4.8.
double chi_square_tail(double x, int degrees_of_freedom) {
  const double half = 0.5 * x;
  int k = degrees_of_freedom % 2 == 0 ? 2 : 1;
  double tail = k == 2 ? std::exp(-half) : std::erfc(std::sqrt(half));
  for (; k < degrees_of_freedom; k += 2) tail += std::exp(0.5 * k * std::log(half) - half - std::lgamma(0.5 * k + 1.0));
  return tail;
}

}  // namespace

double chi_square_quantile(double probability, int degrees_of_freedom) {
  assert(probability >= 0.0 && probability < 1.0 && degrees_of_freedom >= 1);
  double low = 0.0;
  double high = 1.0;
  while (chi_square_tail(high, degrees_of_freedom) > 1.0 - probability) high *= 2.0;
  // Each step halves the interval; 60 of them reach the last bit.
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_tail(middle, degrees_of_freedom) > 1.0 - probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace fabloop
