// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_results.h"

#include <algorithm>
#include <functional>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// The same method in the cells of one group.
struct Replicates {
  std::vector<const CellResult*> cells;
  std::size_t method = 0;

  const MethodResult& of(std::size_t cell) const { return cells[cell]->methods[method]; }
};

std::optional<double> mean_of(std::size_t count, const std::function<std::optional<double>(std::size_t)>& value) {
  double sum = 0.0;
  std::size_t num_known = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> known = value(i);
    sum += known.value_or(0.0);
    num_known += known.has_value();
  }
  // A mean over some of the cells would not compare with one over others.
  return num_known == count && count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

bool has_injected(const BackEndTrial& trial) {
  return std::any_of(trial.loops.begin(), trial.loops.end(), [](const TriedLoop& loop) { return loop.is_injected; });
}

std::vector<StageRow> stage_rows(const Replicates& replicates, const LabDescription& description, std::string& recipe) {
  std::vector<const JudgedRun*> runs;
  for (std::size_t i = 0; i < replicates.cells.size(); ++i) runs.push_back(&replicates.of(i).run);
  StageOptions options = description.evaluation;
  options.only = description.stages;
  std::erase(options.only, Stage::BackEnd);
  std::vector<StageRow> rows;
  StageEvaluation evaluation = evaluate_stages(pooled(runs), options);
  recipe = evaluation.recipe;
  if (!options.only.empty()) {
    for (StageResult& stage : evaluation.stages)
      rows.push_back({std::string(in_words(stage.stage)), std::move(stage), std::nullopt});
  }
  options.only = {Stage::BackEnd};
  for (std::size_t b = 0; b < description.back_ends.size(); ++b) {
    std::vector<JudgedRun> decided;
    for (std::size_t i = 0; i < replicates.cells.size(); ++i)
      decided.push_back(with_back_end(replicates.of(i).run, replicates.of(i).back_ends[b]));
    std::vector<const JudgedRun*> pointers;
    for (const JudgedRun& run : decided) pointers.push_back(&run);
    StageResult stage = std::move(evaluate_stages(pooled(pointers), options).stages.front());
    bool is_injected = false;
    for (std::size_t i = 0; i < replicates.cells.size(); ++i)
      is_injected = is_injected || has_injected(replicates.of(i).back_ends[b]);
    // Injected loops have no score, and would be passed over.
    if (is_injected) forget_ranking(stage);
    rows.push_back({"back end: " + description.back_ends[b].name, std::move(stage),
                    mean_of(replicates.cells.size(), [&](std::size_t i) { return replicates.of(i).back_ends[b].ate_m; })});
  }
  return rows;
}

MethodRows rows_of(const LabCell& cell, const Replicates& replicates, const LabDescription& description) {
  MethodRows rows;
  rows.data = cell.data;
  rows.swept = cell.swept;
  rows.group = cell.group();
  rows.num_cells = replicates.cells.size();
  for (std::size_t i = 0; i < replicates.cells.size(); ++i) rows.num_queries += replicates.of(i).run.queries.size();
  rows.method = replicates.of(0).name;
  rows.label = replicates.of(0).label;
  rows.odometry_ate_m = mean_of(replicates.cells.size(), [&](std::size_t i) { return replicates.cells[i]->odometry_ate_m; });
  rows.stages = stage_rows(replicates, description, rows.recipe);
  return rows;
}

}  // namespace

LabResults evaluate_cells(const std::vector<FinishedCell>& cells, const LabDescription& description, int num_threads) {
  const std::size_t num_methods = description.methods.size(), num_seeds = description.seeds.size();
  LabResults results;
  results.cells.resize(cells.size() * num_methods);
  results.pooled.resize(results.cells.size() / num_seeds);
  parallel_for(results.cells.size() + results.pooled.size(), num_threads, [&](std::size_t i) {
    if (i < results.cells.size()) {
      const FinishedCell& cell = cells[i / num_methods];
      results.cells[i] = rows_of(cell.cell, {{&cell.result}, i % num_methods}, description);
      results.cells[i].seed = cell.cell.seed;
      return;
    }
    const std::size_t group = (i - results.cells.size()) / num_methods;
    Replicates replicates{{}, (i - results.cells.size()) % num_methods};
    for (std::size_t s = 0; s < num_seeds; ++s) replicates.cells.push_back(&cells[group * num_seeds + s].result);
    results.pooled[i - results.cells.size()] = rows_of(cells[group * num_seeds].cell, replicates, description);
  });
  return results;
}

}  // namespace fabloop
