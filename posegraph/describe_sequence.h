// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "frontend/features/feature_extractor.h"
#include "frontend/progress.h"
#include "frontend/sequence/if_damaged.h"
#include "frontend/sequence/sequence.h"

namespace fabloop {

struct DescribeOptions {
  FeatureOptions features;
  IfDamaged if_damaged = IfDamaged::Skip;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  Warn warn{};
  Progress progress{};
};

/// One image of a sequence once it was looked at.
struct DescribedFrame {
  std::size_t frame = 0;  ///< Position in the sequence.
  Features features;
  std::vector<std::uint8_t> grey;  ///< Of the image at each keypoint.
  double read_s = 0;               ///< Seconds spent on decoding.
  double describe_s = 0;           ///< Seconds spent on features.
};

struct DescribedSequence {
  std::vector<DescribedFrame> frames;       ///< In order; damaged images are missing.
  std::vector<std::size_t> damaged_frames;  ///< Positions in the sequence.
};

/// Reads every image once and describes it, in parallel. Throws InputError for a damaged image under `Refuse`, and when no
/// image could be read.
DescribedSequence describe_sequence(const Sequence& sequence, const DescribeOptions& options = {});

}  // namespace fabloop
