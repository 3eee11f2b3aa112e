// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <iostream>

#include "tests/support/tiny_sequence.h"

int main() {
  try {
    fabloop::testing_support::make_tiny_sequence();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
