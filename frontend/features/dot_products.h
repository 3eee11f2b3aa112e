// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// Kernels that use AVX2 and FMA where the processor has them. Every sum is taken in the same order whatever its company, so
// that one machine always gives the same bits. This unit must not include Eigen, whose alignment would change with the
// instruction set.

namespace fabloop {

/// Columns of a panel: what one call of dot_products() fills.
inline constexpr std::size_t kPanelWidth = 16;

/// products[r * stride + j] = rows[r] . panel column j, for num_rows rows of `dimension` floats (contiguous) and a panel of
/// dimension x 16 floats (row-major).
void dot_products(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, float* products,
                  std::size_t stride);

/// An entry of a product of rows and a panel.
struct PanelHit {
  std::uint32_t row;
  std::uint32_t column;
};

/// The entries with rows[r] . panel column <= limits[r]; no others are kept. Returns how many there are; `hits` has room for
/// num_rows x 16, and one more.
std::size_t dot_products_within(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                                const float* limits, PanelHit* hits);

/// sums[j] = (row - mean) . column j of `columns`, a row-major matrix of dimension x num_columns, in double precision.
/// num_columns is a multiple of 8.
void centred_products(const float* row, const double* mean, std::size_t dimension, const double* columns, std::size_t num_columns,
                      double* sums);

/// The squared Euclidean distance of two rows, from their differences: more exact than from norms and a dot product.
float squared_distance(const float* a, const float* b, std::size_t dimension);

}  // namespace fabloop
