// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

// What is done with rows of distances, by AVX2 where the processor has it. Sizes are multiples of kRowStep: rows are padded
// with infinity.

namespace fabloop {

/// Rows of distances are padded to a multiple of it.
inline constexpr std::size_t kRowStep = 16;

/// Makes products squared distances, in place: values[i] becomes max(0, squared_norm + squared_norms[i] - 2 values[i]).
void squared_distances_from_products(float* values, std::size_t size, float squared_norm, const float* squared_norms);

/// The least of the values; infinity for none.
float least_of(const float* values, std::size_t size);

/// The same, and minima[i] = min(minima[i], values[i]) on the way.
float least_of_and_lower(const float* values, std::size_t size, float* minima);

/// Position of the first value that equals `value`, or size.
std::size_t first_equal(const float* values, std::size_t size, float value);

}  // namespace fabloop
