// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "apps/lab/lab_description.h"
#include "apps/lab/lab_results.h"

namespace fabloop {

/// Writes `precision_recall_N.png` for each group of the pooled results, in their order: a curve a method, of appearance alone.
/// None where that stage is not among the description's. Where exactly one parameter is swept, also
/// `false_share_DATA_METHOD.png`: what each stage lets through against it.
void write_lab_figures(const std::filesystem::path& folder, const LabResults& results, const LabDescription& description);

}  // namespace fabloop
