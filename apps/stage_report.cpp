// SPDX-License-Identifier: BSD-3-Clause
#include "apps/stage_report.h"

#include <iomanip>
#include <string>

#include "apps/lab/figure_output.h"
#include "frontend/output_file.h"

namespace fabloop::apps {
namespace {

using nlohmann::ordered_json;

ordered_json curve_json(const PrecisionRecallCurve& curve) {
  ordered_json thresholds = ordered_json::array(), precisions = ordered_json::array(), recalls = ordered_json::array();
  for (const PrecisionRecallPoint& point : curve.points) {
    thresholds.push_back(point.threshold);
    precisions.push_back(point.precision);
    recalls.push_back(point.recall);
  }
  return {{"positives", curve.num_positives}, {"threshold", thresholds}, {"precision", precisions}, {"recall", recalls}};
}

ordered_json calibration_json(const Calibration& calibration) {
  ordered_json bins = ordered_json::array();
  for (const ReliabilityBin& bin : calibration.bins) {
    bins.push_back({{"lowest", bin.lowest},
                    {"highest", bin.highest},
                    {"count", bin.count},
                    {"mean_score", bin.mean_score},
                    {"share_true", bin.share_true}});
  }
  return {{"decisions", calibration.num_decisions}, {"bins", bins}};
}

ordered_json stage_json(const StageResult& stage) {
  ordered_json json = {{"stage", in_words(stage.stage)},
                       {"score", stage.score},
                       {"before", {{"true", stage.num_true_before}, {"false", stage.num_false_before}}},
                       {"passed", {{"true", stage.num_true}, {"false", stage.num_false}, {"unjudged", stage.num_unjudged}}}};
  for (const StageFigure& named : stage_figures()) json[std::string(named.name)] = figure_json(stage.*named.figure);
  ordered_json recall_at = ordered_json::object();
  for (const RecallAt& at : stage.recall_at) recall_at[std::to_string(at.k)] = at.recall;
  json["recall_at"] = recall_at;
  json["curve"] = stage.curve ? curve_json(*stage.curve) : ordered_json(nullptr);
  json["calibration"] = stage.calibration ? calibration_json(*stage.calibration) : ordered_json(nullptr);
  return json;
}

void write_stages_csv(const std::filesystem::path& path, const StageEvaluation& evaluation) {
  OutputFile file(path);
  file.stream() << "# " << evaluation.recipe << "\nstage,score,true_before,false_before,true,false,unjudged";
  for (const StageFigure& named : stage_figures()) put_figure_names(file.stream(), named);
  for (const RecallAt& at : evaluation.stages.front().recall_at) file.stream() << ",recall_at_" << at.k;
  file.stream() << '\n';
  for (const StageResult& stage : evaluation.stages) {
    file.stream() << in_words(stage.stage) << ',' << stage.score << ',' << stage.num_true_before << ',' << stage.num_false_before
                  << ',' << stage.num_true << ',' << stage.num_false << ',' << stage.num_unjudged;
    for (const StageFigure& named : stage_figures()) put_figure(file.stream(), stage.*named.figure);
    for (const RecallAt& at : stage.recall_at) put_field(file.stream(), at.recall);
    file.stream() << '\n';
  }
  file.commit();
}

void write_curves_csv(const std::filesystem::path& path, const StageEvaluation& evaluation) {
  OutputFile file(path);
  file.stream() << "stage,threshold,precision,recall\n";
  for (const StageResult& stage : evaluation.stages) {
    if (!stage.curve) continue;
    for (const PrecisionRecallPoint& point : stage.curve->points) {
      file.stream() << in_words(stage.stage);
      for (const double value : {point.threshold, point.precision, point.recall}) put_field(file.stream(), value);
      file.stream() << '\n';
    }
  }
  file.commit();
}

void write_calibration_csv(const std::filesystem::path& path, const StageEvaluation& evaluation) {
  OutputFile file(path);
  file.stream() << "stage,lowest,highest,count,mean_score,share_true\n";
  for (const StageResult& stage : evaluation.stages) {
    if (!stage.calibration) continue;
    for (const ReliabilityBin& bin : stage.calibration->bins) {
      file.stream() << in_words(stage.stage) << ',' << bin.lowest << ',' << bin.highest << ',' << bin.count;
      put_field(file.stream(), bin.count > 0 ? std::optional(bin.mean_score) : std::nullopt);
      put_field(file.stream(), bin.count > 0 ? std::optional(bin.share_true) : std::nullopt);
      file.stream() << '\n';
    }
  }
  file.commit();
}

}  // namespace

StageEvaluation evaluate_stages(const JudgedRun& run, const RunKind& kind, const StageOptions& options) {
  StageEvaluation evaluation = fabloop::evaluate_stages(run, options);
  if (!kind.is_from_images) return evaluation;
  for (StageResult& stage : evaluation.stages) forget_ranking(stage);
  evaluation.recipe += "; structure from motion tries all its pairs alike, so nothing is said of their order and probabilities";
  return evaluation;
}

ordered_json stages_json(const StageEvaluation& evaluation) {
  ordered_json stages = ordered_json::array();
  for (const StageResult& stage : evaluation.stages) stages.push_back(stage_json(stage));
  return {{"queries", evaluation.num_queries},
          {"queries_with_true_match", evaluation.num_queries_with_true_match},
          {"stages", stages},
          {"recipe", evaluation.recipe}};
}

void print_stages(std::ostream& out, const StageEvaluation& evaluation) {
  out << "stages\n  " << std::left << std::setw(12) << "" << std::right << std::setw(8) << "true" << std::setw(8) << "false"
      << std::setw(8) << "unsure";
  for (const StageFigure& named : stage_figures()) out << "  " << std::left << std::setw(18) << named.title;
  out << '\n';
  for (const StageResult& stage : evaluation.stages) {
    out << "  " << std::left << std::setw(12) << in_words(stage.stage) << std::right << std::setw(8) << stage.num_true
        << std::setw(8) << stage.num_false << std::setw(8) << stage.num_unjudged;
    for (const StageFigure& named : stage_figures())
      out << "  " << std::left << std::setw(18) << figure_text(stage.*named.figure);
    out << '\n';
  }
  for (const StageResult& stage : evaluation.stages) {
    if (stage.recall_at.empty()) continue;
    out << "  " << std::left << std::setw(12) << in_words(stage.stage) << std::right;
    for (const RecallAt& at : stage.recall_at) out << "  recall@" << at.k << ' ' << std::setprecision(3) << at.recall;
    out << '\n';
  }
  out << "  recipe: " << evaluation.recipe << '\n';
}

void write_stage_tables(const std::filesystem::path& folder, const StageEvaluation& evaluation) {
  write_stages_csv(folder / "stages.csv", evaluation);
  write_curves_csv(folder / "precision_recall.csv", evaluation);
  write_calibration_csv(folder / "calibration.csv", evaluation);
}

}  // namespace fabloop::apps
