// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/lab/lab_settings.h"
#include "frontend/baselines/place_method.h"
#include "frontend/features/feature_options.h"
#include "posegraph/evaluation/stage_evaluation.h"
#include "posegraph/robust/back_end.h"

namespace fabloop {

/// A synthetic world and the flight over it; see SyntheticFlightOptions.
struct SyntheticData {
  double length_m = 500.0, spacing_m = 4.0;
  double mean_height_m = 29.0, height_spread_m = 7.0, max_strip_gap_m = 22.0;
  double texture_m_per_px = 0.05, height_m_per_px = 0.1;  ///< Coarser is faster to make.
  double camera_scale = 1.0;                              ///< On the size of the images.
  double tile_m = 40.0;                                   ///< Of aliasing; see AliasingOptions.
};

/// A sequence folder with its truth.
struct SequenceData {
  std::string folder;  ///< As the description names it: relative to the folder of data.
  double height_above_ground_m = 60.0;
  /// The folder of a flight over another place, whose frames are in the map before; empty: none. All pairs across are false.
  std::string earlier{};
};

/// A way to propose places.
struct LabMethod {
  std::string name;
  std::optional<PlaceMethod> method;  ///< None: scores from a file.
  /// Its path, relative to the description. "{data}", "{seed}" and the name of any parameter in braces become the cell's.
  std::string scores;
};

/// A back end as an experiment names it.
struct LabBackEnd {
  std::string name;
  std::optional<BackEnd> back_end;  ///< None ("map"): what the mapper does, the Cauchy loss and then withdrawal.
};

/// A parameter and the values that it takes in turn.
struct LabSweep {
  const LabParameter* parameter = nullptr;
  std::vector<double> values;
};

/// One experiment, which makes one table: data, what goes wrong with them, and what is compared.
struct LabDescription {
  std::filesystem::path path;  ///< The file; for messages.
  std::string text;            ///< Its bytes, as they were read.
  std::string title;
  std::optional<SyntheticData> synthetic;  ///< Either this or sequences.
  std::vector<SequenceData> sequences;
  std::vector<std::uint64_t> seeds = {1};  ///< Each makes the experiment once more: another world, other troubles.
  LabSettings settings;
  std::vector<LabSweep> sweep;  ///< Every combination is tried.
  std::vector<LabMethod> methods;
  std::vector<Stage> stages;  ///< In their order.
  std::vector<LabBackEnd> back_ends;
  FeatureOptions features;
  StageOptions evaluation;

  bool has_stage(Stage stage) const;
  /// Whether pairs must be verified at all.
  bool verifies() const { return stages.size() > 1 || !has_stage(Stage::Appearance); }
};

/// Reads a description (YAML; its keys are in this folder's README). Throws InputError with file and line for a key that is not
/// known, a value that is none or out of range, and what does not fit together.
LabDescription read_lab_description(const std::filesystem::path& path);

}  // namespace fabloop
