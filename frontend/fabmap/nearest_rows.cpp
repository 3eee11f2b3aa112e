// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/nearest_rows.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "frontend/features/descriptor_distances.h"
#include "frontend/parallel.h"

namespace fabloop {

NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads) {
  assert(rows.rows > 0 && rows.cols == points.cols && rows.isContinuous() && points.isContinuous());
  constexpr int kBlockSize = 256;  // its distances to 2,000 words fit the second-level cache
  NearestRows result{std::vector<std::uint32_t>(static_cast<std::size_t>(points.rows)),
                     std::vector<float>(static_cast<std::size_t>(points.rows))};
  const PackedDescriptors packed(rows);
  const auto num_blocks = static_cast<std::size_t>((points.rows + kBlockSize - 1) / kBlockSize);
  parallel_for(num_blocks, num_threads, [&](std::size_t block) {
    const int begin = static_cast<int>(block) * kBlockSize;
    const int end = std::min(begin + kBlockSize, points.rows);
    const cv::Mat1f distances = packed.squared_distances(points.rowRange(begin, end));
    for (int p = begin; p < end; ++p) {
      const float* row = distances.ptr<float>(p - begin);
      const float* nearest = std::min_element(row, row + rows.rows);
      result.row[static_cast<std::size_t>(p)] = static_cast<std::uint32_t>(nearest - row);
      result.squared_distance[static_cast<std::size_t>(p)] = *nearest;
    }
  });
  return result;
}

}  // namespace fabloop
