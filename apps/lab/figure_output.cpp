// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/figure_output.h"

#include <iomanip>
#include <limits>
#include <sstream>

namespace fabloop {

nlohmann::ordered_json figure_json(const EstimatedFigure& figure) {
  if (!figure.value) return nullptr;
  nlohmann::ordered_json json = {{"value", *figure.value}};
  if (figure.interval) {
    json["low"] = figure.interval->low;
    json["high"] = figure.interval->high;
  }
  return json;
}

std::string figure_text(const EstimatedFigure& figure) {
  if (!figure.value) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << *figure.value;
  if (figure.interval) text << std::setprecision(2) << " [" << figure.interval->low << ", " << figure.interval->high << ']';
  return text.str();
}

void put_field(std::ostream& out, const std::optional<double>& value) {
  out << ',';
  if (value) out << std::setprecision(std::numeric_limits<double>::max_digits10) << *value;
}

void put_figure(std::ostream& out, const EstimatedFigure& figure) {
  put_field(out, figure.value);
  put_field(out, figure.interval ? std::optional(figure.interval->low) : std::nullopt);
  put_field(out, figure.interval ? std::optional(figure.interval->high) : std::nullopt);
}

void put_figure_names(std::ostream& out, const StageFigure& named) {
  out << ',' << named.name << ',' << named.name << "_low," << named.name << "_high";
}

}  // namespace fabloop
