// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/optimize.h"

namespace fabloop::test {

inline constexpr Objective kObjectives[] = {Objective::Chordal, Objective::RotationVector, Objective::Quaternion};

}  // namespace fabloop::test
