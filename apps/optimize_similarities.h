// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "apps/robust_arguments.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/optimize.h"

namespace fabloop::apps {

/// What of the options of `optimize` a file of similarities needs beside those of the solver.
struct SimilarityArguments {
  std::string in, out, objective;
  bool certify = false;
};

/// `optimize` for a file of similarities: reads, solves, writes and prints. Throws InputError for options that are of poses
/// alone.
void optimize_similarities(const SimilarityArguments& arguments, const RobustArguments& robust, OptimizeOptions options,
                           const G2oOptions& g2o_options);

}  // namespace fabloop::apps
