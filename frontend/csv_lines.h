// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fabloop {

/// The fields of a line, without the blanks around them.
using CsvFields = std::vector<std::string>;

/// Throws InputError that names file and line.
using CsvFail = std::function<void(const std::string& what)>;

/// Calls `read` with the fields of each line that is neither empty nor a comment (`#`). Throws InputError when the file cannot
/// be read.
void for_each_csv_line(const std::filesystem::path& path, const std::function<void(const CsvFields&, const CsvFail&)>& read);

/// A whole number from 0, else `fail`.
std::size_t parse_position(const std::string& text, const CsvFail& fail);

/// A finite number, else `fail`.
double parse_number(const std::string& text, const CsvFail& fail);

}  // namespace fabloop
