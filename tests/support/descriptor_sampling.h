// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace fabloop::testing_support {

/// `count` descriptors of `dimensions` floats around `num_clusters` well separated centres.
cv::Mat clustered_descriptors(int count, int dimensions, int num_clusters, std::uint64_t seed);

}  // namespace fabloop::testing_support
