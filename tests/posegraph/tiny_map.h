// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontend/sequence/sequence.h"
#include "posegraph/map_sequence.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop::testing_support {

/// The tiny flight with its odometry and its truth.
inline Sequence read_tiny_sequence() {
  SequenceOptions options;
  options.odometry = tiny_sequence() / "odometry.tum";
  return read_sequence(tiny_sequence(), options);
}

/// Few features and hypotheses, so that mapping the flight takes a second.
inline MapSequenceOptions tiny_map_options() {
  MapSequenceOptions options;
  options.features.max_features = 300;
  options.mapper.loops.hypotheses.max_hypotheses = 3;
  options.num_threads = 2;
  return options;
}

}  // namespace fabloop::testing_support
