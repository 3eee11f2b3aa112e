// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frontend/fabmap/model.h"

namespace fabloop {

/// A name for what gives words their meaning: the features' options, the vocabulary, the tree and the detector. Observations may
/// be compared when their models have the same; where a model came from does not count. 16 hexadecimal digits.
std::string model_hash(const Model& model);

}  // namespace fabloop
