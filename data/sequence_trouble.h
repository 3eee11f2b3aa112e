// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "frontend/output_file.h"

namespace fabloop {

/// What is to go wrong with a sequence. Shares are met to the nearest frame or step, not on average; which ones, the seed tells.
/// By default nothing goes wrong.
struct SequenceTrouble {
  std::uint64_t seed = 1;
  double dropped_frames = 0.0;   ///< Share of the frames that are missing, in [0, 1).
  double blurred_frames = 0.0;   ///< Share of the frames that are out of focus,
  double blur_px = 4.0;          ///< by a Gaussian of this standard deviation.
  double exposed_frames = 0.0;   ///< Share of the frames that are exposed wrongly,
  double exposure_stops = 2.0;   ///< by so many stops, too dark or too light by a coin toss; what is too light is white.
  double occluded_frames = 0.0;  ///< Share of the frames of which a rectangle is covered,
  double occluded_area = 0.3;    ///< which is this share of the picture.
  double focal_error = 0.0;      ///< Wrong calibration: the focal lengths are told too long by this share (negative: too short).
  double odometry_translation_noise = 0.0;   ///< Standard deviation of each axis, as a share of the step's length.
  double odometry_rotation_noise_deg = 0.0;  ///< Standard deviation of each axis, at each step.
  double odometry_slips = 0.0;               ///< Share of the steps that slip: they come out anything from no to double length,
  double slip_heading_deg = 20.0;  ///< and turned about the odometry's z axis by up to this angle (uniform, both signs).
};

/// Whether nothing is to go wrong.
bool is_trouble_free(const SequenceTrouble& trouble);

/// How much went wrong.
struct TroubledSequence {
  std::size_t num_frames = 0;  ///< Left after dropping.
  std::size_t num_dropped = 0, num_blurred = 0, num_exposed = 0, num_occluded = 0;
  std::size_t num_steps = 0, num_slips = 0;
};

/// Writes a copy of a sequence folder (`camera.yaml`, images, `odometry.tum`, and where there are any `reference.tum` and
/// `pairs.csv`, whose frames are numbered anew) in which things went wrong. Frames that nothing happens to are copied byte by
/// byte; the others are PNG files. Overlaps are those of the whole frames. The same seed gives the same folder. Throws InputError
/// for shares outside [0, 1], when the sequence cannot be read, and as OutputFolder does.
TroubledSequence write_troubled_sequence(const std::filesystem::path& from, const std::filesystem::path& to,
                                         const SequenceTrouble& trouble,
                                         OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse);

}  // namespace fabloop
