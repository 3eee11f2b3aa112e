// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/cluster_means.h"

#include <cassert>

#include "frontend/parallel.h"

namespace fabloop {

std::vector<std::size_t> move_to_means(cv::Mat& centres, const cv::Mat& points, const std::vector<std::uint32_t>& assignment,
                                       int num_threads) {
  assert(assignment.size() == static_cast<std::size_t>(points.rows) && centres.cols == points.cols);
  const auto num_centres = static_cast<std::size_t>(centres.rows);
  std::vector<std::vector<int>> members(num_centres);
  for (std::size_t i = 0; i < assignment.size(); ++i) members[assignment[i]].push_back(static_cast<int>(i));
  std::vector<std::size_t> sizes;
  for (const auto& cluster : members) sizes.push_back(cluster.size());

  parallel_for(num_centres, num_threads, [&](std::size_t centre) {
    if (members[centre].empty()) return;
    std::vector<double> sum(static_cast<std::size_t>(points.cols), 0.0);
    for (const int member : members[centre]) {
      const auto* point = points.ptr<float>(member);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<double>(point[i]);
    }
    auto* mean = centres.ptr<float>(static_cast<int>(centre));
    for (std::size_t i = 0; i < sum.size(); ++i) mean[i] = static_cast<float>(sum[i] / static_cast<double>(sizes[centre]));
  });
  return sizes;
}

}  // namespace fabloop
