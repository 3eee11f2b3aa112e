// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace fabloop {

/// Whether an encoded image has its end. Decoders fill what a truncated JPEG lacks with grey and say nothing, so JPEG
/// (ITU-T T.81, annex B) and PNG (ISO/IEC 15948, clause 5) files are walked to their end marker; bytes after it do not matter.
/// Other formats count as complete here: their decoders refuse what is truncated.
bool is_complete_image(std::span<const std::uint8_t> bytes);

}  // namespace fabloop
