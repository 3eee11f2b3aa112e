// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "frontend/output_file.h"
#include "frontend/progress.h"
#include "frontend/sequence/if_damaged.h"
#include "frontend/sequence/keyframe_choice.h"

namespace fabloop {

struct KeyframeFolderOptions {
  KeyframeChoiceOptions choice{};
  std::filesystem::path camera{};  ///< Calibration to go with the images. Empty: the source folder's, where it has one.
  IfDamaged if_damaged = IfDamaged::Skip;
  OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse;
  int num_threads = 0;  ///< 0: all. For the decoding of image files.
  Warn warn{};
  Progress progress{};
};

struct KeyframeCount {
  std::size_t num_images = 0;  ///< That could be read.
  std::size_t num_keyframes = 0;
};

/// The keyframes of a video, or of a folder of images at video rate, as a sequence folder of its own: `images/` (a folder's files
/// as they are; a video's frames as JPEG), `frames.csv` with their times, `camera.yaml`, and the source's `odometry.tum`,
/// `reference.tum` and `gps.csv`, whose other lines do no harm. Files that count images, such as `pairs.csv`, do not come along.
/// Throws InputError as ImageSource and OutputFolder do, for a calibration that is not one, for an output that would replace its
/// own source, and for image names that `frames.csv` cannot hold.
KeyframeCount write_keyframe_folder(const std::filesystem::path& source, const std::filesystem::path& out,
                                    const KeyframeFolderOptions& options = {});

}  // namespace fabloop
