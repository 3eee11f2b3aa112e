// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fabloop {

/// What to do with an image that cannot be read.
enum class IfDamaged {
  Skip,    ///< Warn, count and go on.
  Refuse,  ///< Throw InputError.
};

}  // namespace fabloop
