// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/fabmap/precision_recall.h"

namespace fabloop {

/// Precision against recall, with its figures and its recipe (BGR, 8 bit). A picture without a curve where there is none.
cv::Mat draw_precision_recall(const std::string& title, const PrecisionRecall& result);

/// A curve and what it is of. The curve may be none, and must outlive the call.
struct NamedCurve {
  std::string name;
  const PrecisionRecallCurve* curve = nullptr;
};

/// Several curves to compare, with a legend that gives their figures, and the recipe that they share.
cv::Mat draw_precision_recall(const std::string& title, const std::vector<NamedCurve>& curves, const std::string& recipe);

}  // namespace fabloop
