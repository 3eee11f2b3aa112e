// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_tables.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "apps/lab/figure_output.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

std::string seed_text(const MethodRows& rows) { return rows.seed ? std::to_string(*rows.seed) : "all"; }

/// Labels have commas.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

void write_lines(std::ostream& out, const MethodRows& rows, const LabDescription& description) {
  for (const StageRow& row : rows.stages) {
    const StageResult& stage = row.result;
    out << quoted(rows.data) << ',' << seed_text(rows) << ',' << rows.num_cells;
    for (const auto& [name, value] : rows.swept) put_field(out, value);
    out << ',' << quoted(rows.method) << ',' << quoted(rows.label) << ',' << quoted(row.stage) << ',' << stage.score << ','
        << rows.num_queries << ',' << stage.num_true_before << ',' << stage.num_false_before << ',' << stage.num_true << ','
        << stage.num_false << ',' << stage.num_unjudged;
    for (const StageFigure& named : stage_figures()) put_figure(out, stage.*named.figure);
    for (const std::size_t k : description.evaluation.recall_at) {
      const auto found =
          std::find_if(stage.recall_at.begin(), stage.recall_at.end(), [&](const RecallAt& at) { return at.k == k; });
      put_field(out, found == stage.recall_at.end() ? std::nullopt : std::optional(found->recall));
    }
    put_field(out, rows.odometry_ate_m);
    put_field(out, row.ate_m);
    out << '\n';
  }
}

Json json_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json stage_json(const MethodRows& rows, const StageRow& row) {
  Json swept = Json::object();
  for (const auto& [name, value] : rows.swept) swept[name] = value;
  Json json = {
      {"data", rows.data},
      {"seed", rows.seed ? Json(*rows.seed) : Json("all")},
      {"cells", rows.num_cells},
      {"swept", swept},
      {"method", rows.method},
      {"label", rows.label},
      {"stage", row.stage},
      {"score", row.result.score},
      {"queries", rows.num_queries},
      {"before", {{"true", row.result.num_true_before}, {"false", row.result.num_false_before}}},
      {"passed", {{"true", row.result.num_true}, {"false", row.result.num_false}, {"unjudged", row.result.num_unjudged}}}};
  for (const StageFigure& named : stage_figures()) json[std::string(named.name)] = figure_json(row.result.*named.figure);
  for (const RecallAt& at : row.result.recall_at) json["recall_at"][std::to_string(at.k)] = at.recall;
  json["odometry_ate_m"] = json_or_null(rows.odometry_ate_m);
  json["ate_m"] = json_or_null(row.ate_m);
  if (row.result.curve) {
    for (const PrecisionRecallPoint& point : row.result.curve->points) json["curve"].push_back({point.precision, point.recall});
  }
  json["recipe"] = rows.recipe;
  return json;
}

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// Precision told as its complement.
std::optional<Interval> false_interval(const StageResult& stage) {
  if (!stage.precision.interval) return std::nullopt;
  return Interval{1.0 - stage.precision.interval->high, 1.0 - stage.precision.interval->low};
}

const StageRow* row_of(const MethodRows& rows, const std::string& stage) {
  const auto found =
      std::find_if(rows.stages.begin(), rows.stages.end(), [&](const StageRow& row) { return row.stage == stage; });
  return found == rows.stages.end() ? nullptr : &*found;
}

/// All stages that any of the rows has, in the order of the pipeline (consistency may be off in some).
std::vector<std::string> all_stages(const LabResults& results, const LabDescription& description) {
  std::vector<std::string> stages;
  for (const Stage stage : description.stages) {
    if (stage != Stage::BackEnd) stages.emplace_back(in_words(stage));
  }
  for (const LabBackEnd& back_end : description.back_ends) stages.push_back("back end: " + back_end.name);
  std::erase_if(stages, [&](const std::string& stage) {
    return std::none_of(results.pooled.begin(), results.pooled.end(),
                        [&](const MethodRows& rows) { return row_of(rows, stage); });
  });
  return stages;
}

void stage_table(std::ostream& out, const LabResults& results, const LabDescription& description) {
  const std::vector<std::string> stages = all_stages(results, description);
  out << "False ones among those that passed each stage and are judged:\n\n| data | method | queries |";
  for (const std::string& stage : stages) out << ' ' << stage << " |";
  out << "\n|---|---|---|";
  for (std::size_t i = 0; i < stages.size(); ++i) out << "---|";
  out << '\n';
  for (const MethodRows& rows : results.pooled) {
    out << "| " << rows.group << " | " << rows.label << " | " << rows.num_queries << " |";
    for (const std::string& stage : stages) {
      const StageRow* row = row_of(rows, stage);
      out << ' '
          << (row ? share_text(row->result.num_false, row->result.num_true + row->result.num_false, false_interval(row->result))
                  : "off")
          << " |";
    }
    out << '\n';
  }
  out << "\nIn brackets the interval; where none is false, what the share is below by 95 % if the loops were independent.\n";
}

void method_table(std::ostream& out, const LabResults& results, const LabDescription& description) {
  out << "\nHow well each method sorts, before anything is verified:\n\n| data | method | average precision | recall at 100 % "
         "precision |";
  for (const std::size_t k : description.evaluation.recall_at) out << " recall@" << k << " |";
  out << "\n|---|---|---|---|";
  for (std::size_t i = 0; i < description.evaluation.recall_at.size(); ++i) out << "---|";
  out << '\n';
  for (const MethodRows& rows : results.pooled) {
    const StageRow* row = row_of(rows, std::string(in_words(Stage::Appearance)));
    if (!row) continue;
    out << "| " << rows.group << " | " << rows.label << " | " << figure_text(row->result.average_precision) << " | "
        << figure_text(row->result.recall_at_full_precision) << " |";
    for (const RecallAt& at : row->result.recall_at) out << ' ' << fixed(at.recall, 3) << " |";
    out << '\n';
  }
}

void back_end_table(std::ostream& out, const LabResults& results) {
  out << "\nWhat each back end keeps, and the map's error (ATE, mean over the seeds):\n\n"
         "| data | method | back end | true loops kept | false loops kept | ATE odometry [m] | ATE [m] "
         "|\n|---|---|---|---|---|---|---|\n";
  for (const MethodRows& rows : results.pooled) {
    for (const StageRow& row : rows.stages) {
      if (row.result.stage != Stage::BackEnd) continue;
      const StageResult& stage = row.result;
      out << "| " << rows.group << " | " << rows.label << " | " << row.stage.substr(row.stage.find(": ") + 2) << " | "
          << stage.num_true << " of " << stage.num_true_before << " | " << stage.num_false << " of " << stage.num_false_before
          << " | " << (rows.odometry_ate_m ? fixed(*rows.odometry_ate_m, 2) : "-") << " | "
          << (row.ate_m ? fixed(*row.ate_m, 2) : "-") << " |\n";
    }
  }
}

/// A line for each recipe: heights above ground and numbers of queries are the data's.
void recipes(std::ostream& out, const LabResults& results) {
  std::vector<std::pair<std::string, std::string>> groups_of;  // recipe, groups
  for (const MethodRows& rows : results.pooled) {
    auto found = std::find_if(groups_of.begin(), groups_of.end(), [&](const auto& known) { return known.first == rows.recipe; });
    if (found == groups_of.end()) found = groups_of.insert(groups_of.end(), {rows.recipe, ""});
    // The methods of a group stand together.
    const bool is_named = found->second == rows.group || found->second.ends_with("; " + rows.group);
    if (!is_named) found->second += (found->second.empty() ? "" : "; ") + rows.group;
  }
  for (const auto& [recipe, groups] : groups_of) out << "\nRecipe (" << groups << "): " << recipe << ".\n";
}

}  // namespace

std::string share_text(std::size_t part, std::size_t count, const std::optional<Interval>& interval) {
  std::string text = std::to_string(part) + " of " + std::to_string(count);
  if (count == 0) return text;
  if (part == 0) {
    constexpr double kOutside = 0.05;
    const double most = 1.0 - std::pow(kOutside, 1.0 / static_cast<double>(count));
    return text + " (< " + fixed(100.0 * most, 2) + " %)";
  }
  text += ", " + fixed(100.0 * static_cast<double>(part) / static_cast<double>(count), 1) + " %";
  if (interval) text += " [" + fixed(100.0 * interval->low, 1) + ", " + fixed(100.0 * interval->high, 1) + "]";
  return text;
}

void write_results_csv(const std::filesystem::path& path, const LabResults& results, const LabDescription& description) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "data,seed,cells";
  for (const LabSweep& sweep : description.sweep) out << ',' << sweep.parameter->name;
  out << ",method,label,stage,score,queries,true_before,false_before,true,false,unjudged";
  for (const StageFigure& named : stage_figures()) put_figure_names(out, named);
  for (const std::size_t k : description.evaluation.recall_at) out << ",recall_at_" << k;
  out << ",odometry_ate_m,ate_m\n";
  for (const MethodRows& rows : results.cells) write_lines(out, rows, description);
  for (const MethodRows& rows : results.pooled) write_lines(out, rows, description);
  file.commit();
}

void write_results_json(const std::filesystem::path& path, const LabResults& results, const LabDescription& description) {
  Json lines = Json::array();
  for (const auto* list : {&results.cells, &results.pooled}) {
    for (const MethodRows& rows : *list) {
      for (const StageRow& row : rows.stages) lines.push_back(stage_json(rows, row));
    }
  }
  OutputFile file(path);
  file.stream() << Json{{"title", description.title}, {"rows", lines}}.dump(1) << '\n';
  file.commit();
}

std::string results_markdown(const LabResults& results, const LabDescription& description) {
  std::ostringstream out;
  out << "# " << description.title << "\n\n";
  stage_table(out, results, description);
  if (description.has_stage(Stage::Appearance)) method_table(out, results, description);
  if (description.has_stage(Stage::BackEnd)) back_end_table(out, results);
  recipes(out, results);
  return out.str();
}

}  // namespace fabloop
