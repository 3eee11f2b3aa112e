// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/sequence/exif.h"
#include "frontend/sequence/sequence.h"

namespace fabloop {

/// Which images another camera took than most, by make, model and focal length (to 2 %: lenses zoom). One entry a label: what
/// stands in the way, or none. Images without a label are taken for the same camera's; of two groups of one size the first counts.
std::vector<std::optional<std::string>> other_cameras(const std::vector<std::optional<CameraLabel>>& labels);

/// The same of a sequence's images, by their EXIF.
std::vector<std::optional<std::string>> other_cameras(const Sequence& sequence);

}  // namespace fabloop
