// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "frontend/features/feature_options.h"
#include "posegraph/map_sequence.h"
#include "verification/verifier.h"

namespace fabloop {

/// What a run was told, as it stands in `summary.json` under "parameters": the features, how many places were verified, the
/// limits of all gates, confirmation by consecutive images, and the back end.
std::string run_parameters_json(const MapSequenceOptions& options, const FeatureOptions& features);

/// The gates' limits of such an object; what it does not name has its default (older runs). Throws InputError when it is none.
VerifierOptions verifier_options_from_parameters(std::string_view json);

/// The features of such an object. Throws InputError when it does not name them.
FeatureOptions features_from_parameters(std::string_view json);

}  // namespace fabloop
