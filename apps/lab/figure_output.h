// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop {

/// {"value": 0.912, "low": 0.88, "high": 0.94}; without an interval the value alone; null where the figure is not defined.
nlohmann::ordered_json figure_json(const EstimatedFigure& figure);

/// "0.912 [0.88, 0.94]", or "-".
std::string figure_text(const EstimatedFigure& figure);

/// A field of a CSV file and the comma before it: as many digits as it takes to get the same number back; empty where it is not
/// known.
void put_field(std::ostream& out, const std::optional<double>& value);

/// Three such fields: the figure and the ends of its interval.
void put_figure(std::ostream& out, const EstimatedFigure& figure);

/// Their names, each with the comma before it: ",precision,precision_low,precision_high".
void put_figure_names(std::ostream& out, const StageFigure& named);

}  // namespace fabloop
