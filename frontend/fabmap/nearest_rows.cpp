// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/nearest_rows.h"

namespace fabloop {

NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads) {
  constexpr int kManyRows = 1000, kManyPoints = 20000;
  const bool many = rows.rows >= kManyRows && points.rows >= kManyPoints;
  return RowSearch(rows, many ? RowSearchKind::ManyTimes : RowSearchKind::Once).nearest(points, num_threads);
}

}  // namespace fabloop
