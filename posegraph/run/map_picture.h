// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "frontend/sequence/sequence.h"
#include "posegraph/mapper.h"

namespace fabloop {

/// The map from above: odometry grey, reference dashed where known, result in colour, accepted loops drawn, rejected ones
/// faint, with a scale bar and a legend (BGR, 8 bit). "Above" is along the axis in which the result extends least. Odometry and
/// result are aligned to the reference as for the ATE.
cv::Mat draw_map(const Sequence& sequence, const Map& map);

/// Writes draw_map() as PNG. Throws InputError when it cannot be written.
void write_map_picture(const std::filesystem::path& path, const Sequence& sequence, const Map& map);

}  // namespace fabloop
