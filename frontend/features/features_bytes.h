// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontend/features/features.h"
#include "frontend/state_bytes.h"

namespace fabloop {

/// Features as state files and keyframe maps hold them.
void put(StateBytes& bytes, const Features& features);

/// Throws StateDamaged where there is something else.
Features take_features(StateBytes& bytes);

}  // namespace fabloop
