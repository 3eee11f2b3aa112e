// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fabloop {

/// The value that a chi-square variable of `degrees_of_freedom` >= 1 stays below with this probability, in [0, 1).
double chi_square_quantile(double probability, int degrees_of_freedom);

}  // namespace fabloop
