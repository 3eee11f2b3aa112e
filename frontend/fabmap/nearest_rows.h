// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "frontend/fabmap/row_search.h"

namespace fabloop {

/// A search for the rows nearest to so many points, prepared as far as it pays.
RowSearch search_for(const cv::Mat& rows, int num_points);

/// The row of `rows` (W x D, CV_32F, continuous, W >= 1) nearest to each of `points` (N x D, likewise), exactly, on up to
/// `num_threads` threads (0: all). The result does not depend on their number. Who has the same rows for several sets of
/// points keeps a RowSearch.
NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads);

}  // namespace fabloop
