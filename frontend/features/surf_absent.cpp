// SPDX-License-Identifier: BSD-3-Clause
#include <exception>

#include "frontend/error.h"
#include "frontend/features/surf.h"

namespace fabloop {

std::string_view surf_library() { return ""; }

void require_surf() {
  throw InputError("features surf: this program was built without SURF; install libdlib-dev and build again, or give sift");
}

std::vector<cv::KeyPoint> detect_surf(const cv::Mat&, const SurfOptions&, double) { require_surf(), std::terminate(); }

cv::Mat describe_surf(const cv::Mat&, std::vector<cv::KeyPoint>&, Orientation) { require_surf(), std::terminate(); }

}  // namespace fabloop
