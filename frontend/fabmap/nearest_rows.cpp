// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/nearest_rows.h"

namespace fabloop {

RowSearch search_for(const cv::Mat& rows, int num_points) {
  constexpr int kManyRows = 1000, kManyPoints = 20000;
  const bool many = rows.rows >= kManyRows && num_points >= kManyPoints;
  return {rows, many ? RowSearchKind::ManyTimes : RowSearchKind::Once};
}

NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads) {
  return search_for(rows, points.rows).nearest(points, num_threads);
}

}  // namespace fabloop
