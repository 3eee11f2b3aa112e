// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "verification/view.h"

namespace fabloop {

/// log10 of how many models with as many inliers one would expect among `num_matches` matches that are all accidental: the
/// number of false alarms of a-contrario RANSAC (Moisan & Stival, IJCV 2004, eq. 10). Far below 0: no accident.
///
/// `p_accident` is the probability that an accidental match agrees with a given model, `models_per_sample` how many models
/// the minimal solver returns at most.
double log10_false_alarms(std::size_t num_matches, std::size_t num_inliers, std::size_t sample_size, double p_accident,
                          double models_per_sample);

/// Probability that a random feature of the view agrees with an epipolar geometry within `max_error_px` of the image in which it
/// was found: the band's share of the image.
double p_accidental_epipolar_match(const View& view, double max_error_px);

}  // namespace fabloop
