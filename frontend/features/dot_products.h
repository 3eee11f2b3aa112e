// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace fabloop {

/// Columns that one call of dot_products() fills.
inline constexpr std::size_t kPanelWidth = 16;

/// products[r * stride + j] = rows[r] . panel column j, for num_rows rows of `dimension` floats (contiguous) and a panel of
/// dimension x 16 floats (row-major). Uses AVX2 and FMA where the processor has them. This unit must not include Eigen, whose
/// alignment would change with the instruction set.
void dot_products(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, float* products,
                  std::size_t stride);

}  // namespace fabloop
