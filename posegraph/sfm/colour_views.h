// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core/matx.hpp>
#include <string>
#include <vector>

#include "frontend/features/feature_options.h"
#include "frontend/progress.h"
#include "frontend/sequence/if_damaged.h"
#include "frontend/sequence/sequence.h"
#include "frontend/work_state.h"
#include "verification/view.h"

namespace fabloop {

struct ColourViewsOptions {
  FeatureOptions features;
  IfDamaged if_damaged = IfDamaged::Skip;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  /// Where each view is kept as soon as it is known, and looked up instead of read again. Not owned; null: nowhere.
  WorkState* state = nullptr;
  Warn warn;
  Progress progress;
};

/// An image as geometry sees it, with the colour at each feature.
struct ColourView {
  View view;
  std::vector<cv::Vec3b> red_green_blue;
};

/// An image that structure from motion cannot use, and why.
struct UnreadFrame {
  std::size_t frame = 0;  ///< Position in the sequence.
  std::string why;
};

/// N images as geometry sees them, with the colour at each feature.
struct ColourViews {
  std::vector<View> views;                             ///< N, in the sequence's order.
  std::vector<std::vector<cv::Vec3b>> red_green_blue;  ///< N, one a feature.
  std::vector<UnreadFrame> unread;                     ///< Damaged, of another size than the camera's, or another camera's.
};

/// Reads every image once and describes it, in parallel; no more images are in memory than there are threads. Throws InputError
/// for a bad image under `Refuse`, and when none could be read. Images of another camera than most by their EXIF (other_cameras())
/// are left out.
ColourViews read_colour_views(const Sequence& sequence, const ColourViewsOptions& options = {});

}  // namespace fabloop
