// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "posegraph/sfm/exposure.h"
#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"
#include "posegraph/sfm/image_cache.h"

namespace fabloop {

/// Heights of part of a grid's cells.
cv::Mat1f heights_of(const HeightField& surface, const GroundGrid& grid, const cv::Rect& part);

/// A view laid onto part of a grid with the heights of these cells, BGR, exposure equalised, which may be brighter than 255;
/// reflected beyond the image's border. `index` and `camera` are those of the view in `exposure`.
cv::Mat3f lay_view(const GroundGrid& grid, const cv::Rect& part, const cv::Mat1f& heights, const GroundView& view,
                   const ImagePyramid& pyramid, const Exposure& exposure, std::size_t index, std::size_t camera);

}  // namespace fabloop
