// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "data/sequence_trouble.h"

namespace fabloop {

/// All numbers that an experiment may set or sweep. The defaults are an undisturbed sequence and the program's own settings.
struct LabSettings {
  double aliasing = 0.0;                                       ///< See AliasingOptions::share. Synthetic worlds only.
  double drift = 1.0;                                          ///< Factor on every error of a synthetic world's odometry.
  SequenceTrouble trouble;                                     ///< Its seed is the cell's.
  double random_false_loops = 0.0, grouped_false_loops = 0.0;  ///< Shares of the loops that are added false ones; one of them.
  double false_loop_group_size = 10.0;
  double top = 10.0;                 ///< Places proposed for each query.
  double window = 10.0;              ///< Most recent places that are left out, and frames that are not judged.
  double consistency = 0.0;          ///< See ConsistencyOptions::num_required. 0: that stage is off, as it is by default.
  double min_inliers = 15.0;         ///< See VerifierOptions.
  double inlier_probability = 0.99;  ///< See RobustOptions.
};

/// One of those numbers.
struct LabParameter {
  std::string_view name;  ///< In descriptions and columns.
  std::string_view what;  ///< For readers.
  double low, high;       ///< What it may be, ends included.
  bool is_whole;          ///< Only whole numbers.
  bool changes_images;    ///< Another value makes other images, or numbers them anew.
  double& (*of)(LabSettings& settings);
};

/// All of them.
std::span<const LabParameter> lab_parameters();

/// The one of that name; null for another name.
const LabParameter* lab_parameter(std::string_view name);

}  // namespace fabloop
