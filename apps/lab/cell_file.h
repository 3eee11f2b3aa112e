// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/lab/cell_run.h"
#include "apps/lab/lab_cell.h"

namespace fabloop {

/// Writes a cell's result as JSON, under its checksum; the file appears when it is complete. Numbers come back exactly.
void write_cell(const std::filesystem::path& path, const std::string& checksum, const LabCell& cell, const CellResult& result);

/// Reads it back; none where there is no such file. Throws InputError when it is damaged or is that of another cell.
std::optional<CellResult> read_cell(const std::filesystem::path& path, const std::string& checksum);

}  // namespace fabloop
