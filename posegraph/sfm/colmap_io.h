// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// Reads a COLMAP text model (`cameras.txt`, `images.txt`, `points3D.txt`). Pixels and principal points come down by half a pixel
/// (COLMAP's first pixel has its centre at (0.5, 0.5), ours at (0, 0)), poses are inverted (COLMAP's are camera_from_world),
/// observations without a point are left out. Camera models: SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV,
/// OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE.
///
/// `images` is the folder that the model's image names start from (or whose `images/` is that): frames and times are as
/// list_stamped_images() gives them for it. Where it is empty or an image is not there, frames are counted in the order of image
/// ids, a second apart. The unit is arbitrary and there is no origin: COLMAP says nothing of them. Throws InputError naming file
/// and line.
Reconstruction read_colmap_model(const std::filesystem::path& folder, const std::filesystem::path& images = {});

/// Writes a COLMAP text model that COLMAP opens: the ids are positions from 1. Image names are relative to the deepest folder
/// that holds all images; COLMAP reads no name with a blank. Lenses become PINHOLE, OPENCV, FULL_OPENCV or OPENCV_FISHEYE.
/// Numbers read back as the same bits, but for the half pixel's rounding. Throws InputError when it cannot be written.
void write_colmap_model(const std::filesystem::path& folder, const Reconstruction& reconstruction);

}  // namespace fabloop
