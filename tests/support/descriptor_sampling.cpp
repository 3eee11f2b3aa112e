// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/descriptor_sampling.h"

namespace fabloop::testing_support {

cv::Mat clustered_descriptors(int count, int dimensions, int num_clusters, std::uint64_t seed) {
  cv::RNG generator(seed);
  cv::Mat centres(num_clusters, dimensions, CV_32F);
  generator.fill(centres, cv::RNG::UNIFORM, 0.0, 10.0);
  cv::Mat descriptors(count, dimensions, CV_32F);
  generator.fill(descriptors, cv::RNG::NORMAL, 0.0, 0.2);
  for (int i = 0; i < count; ++i) descriptors.row(i) += centres.row(i % num_clusters);
  return descriptors;
}

}  // namespace fabloop::testing_support
