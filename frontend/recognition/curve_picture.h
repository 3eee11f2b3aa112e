// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "frontend/fabmap/precision_recall.h"

namespace fabloop {

/// Precision against recall, with its figures and its recipe (BGR, 8 bit). A picture without a curve where there is none.
cv::Mat draw_precision_recall(const std::string& title, const PrecisionRecall& result);

}  // namespace fabloop
