// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "apps/lab/lab_description.h"
#include "apps/lab/lab_results.h"

namespace fabloop {

/// A line for each cell (with its seed) or group (seed "all"), method and stage: data, swept values, counts, every figure with
/// the ends of its interval, recall@K, errors. Numbers come back exactly; what is not defined is empty.
void write_results_csv(const std::filesystem::path& path, const LabResults& results, const LabDescription& description);

/// The same as JSON, an object a line of the CSV file, with the curves.
void write_results_json(const std::filesystem::path& path, const LabResults& results, const LabDescription& description);

/// The pooled figures for readers, in Markdown: what each stage lets through, how well each method sorts, what back ends make of
/// it.
std::string results_markdown(const LabResults& results, const LabDescription& description);

/// A share and how far it may be off, in percent. Where nothing of `count` was found the interval is the exact one-sided one of
/// 95 % (Clopper & Pearson 1934), since a bootstrap of zeros is blind.
std::string share_text(std::size_t part, std::size_t count, const std::optional<Interval>& interval);

}  // namespace fabloop
