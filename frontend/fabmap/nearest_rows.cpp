// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/nearest_rows.h"

#include <faiss/utils/distances.h>
#include <omp.h>

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

constexpr std::size_t kBlockSize = 1024;

/// faiss takes as many threads as OpenMP allows the calling thread; ours are enough.
class SingleOpenMpThread {
 public:
  SingleOpenMpThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~SingleOpenMpThread() { omp_set_num_threads(before_); }
  SingleOpenMpThread(const SingleOpenMpThread&) = delete;
  SingleOpenMpThread& operator=(const SingleOpenMpThread&) = delete;

 private:
  int before_;
};

}  // namespace

NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads) {
  assert(rows.rows > 0 && rows.cols == points.cols && rows.isContinuous() && points.isContinuous());
  const auto count = static_cast<std::size_t>(points.rows);
  NearestRows result{std::vector<std::uint32_t>(count), std::vector<float>(count)};
  const std::size_t num_blocks = (count + kBlockSize - 1) / kBlockSize;
  parallel_for(num_blocks, num_threads, [&](std::size_t block) {
    const SingleOpenMpThread guard;
    const std::size_t begin = block * kBlockSize;
    const std::size_t size = std::min(kBlockSize, count - begin);
    std::vector<std::int64_t> nearest(size);
    faiss::knn_L2sqr(points.ptr<float>(static_cast<int>(begin)), rows.ptr<float>(), static_cast<std::size_t>(points.cols), size,
                     static_cast<std::size_t>(rows.rows), 1, result.squared_distance.data() + begin, nearest.data());
    std::transform(nearest.begin(), nearest.end(), result.row.begin() + static_cast<std::ptrdiff_t>(begin),
                   [](std::int64_t row) { return static_cast<std::uint32_t>(row); });
  });
  return result;
}

}  // namespace fabloop
