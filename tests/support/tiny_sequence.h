// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "data/world_writer.h"

namespace fabloop::testing_support {

/// A flight with as few and as small images as can be mapped: it comes back to its start once.
SyntheticFlightOptions tiny_sequence_options();

/// Renders that flight anew. ctest does so before the tests that need it (fixture `tiny_sequence`), so that not each of them
/// pays for it.
void make_tiny_sequence();

/// The flight's sequence folder, to be read only; rendered where it is missing.
std::filesystem::path tiny_sequence();

/// A copy of its first frames that a test may spoil.
void copy_tiny_sequence(const std::filesystem::path& folder, std::size_t num_frames);

}  // namespace fabloop::testing_support
