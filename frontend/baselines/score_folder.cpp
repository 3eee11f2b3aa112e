// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/score_folder.h"

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "frontend/npy.h"
#include "frontend/recognition/curve_picture.h"
#include "frontend/recognition/judged_output.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void write_matrix(const fs::path& path, const ScoreTable& table) {
  NpyWriter matrix(path, NpyType::Float64, table.place_frames.size());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const ScoreRow& row : table.rows) {
    std::vector<double> scores = row.scores;
    for (double& score : scores) {
      if (score == -std::numeric_limits<double>::infinity()) score = kNone;
    }
    matrix.add_row(scores, kNone);
  }
  matrix.commit();
}

void write_hypotheses(const fs::path& path, const ScoreReport& report) {
  OutputFile file(path);
  file.stream() << "query,rank,match,score\n";
  for (const ScoredQuery& query : scored_queries(report.table, report.max_matches)) {
    for (std::size_t rank = 0; rank < query.matches.size(); ++rank) {
      const ScoredMatch& match = query.matches[rank];
      file.stream() << query.frame << ',' << rank + 1 << ',' << report.table.place_frames[match.place] << ','
                    << exact_text(match.score) << '\n';
    }
  }
  file.commit();
}

void write_summary(const fs::path& path, const ScoreReport& report) {
  nlohmann::ordered_json summary;
  summary["sequence"] = report.sequence;
  summary["map"] = report.map.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(report.map);
  summary["method"] = report.method;
  summary["label"] = report.table.label;
  summary["frames"] = {{"images", report.table.rows.size()}, {"damaged", report.num_damaged}};
  summary["places"] = report.table.place_frames.size();
  summary["precision_recall"] = judged_json(report.judged, "score");
  summary["options"] = {{"window", report.num_recent_excluded}, {"top", report.max_matches}};
  summary["versions"] = {{"fabloop", FABLOOP_VERSION}};
  OutputFile file(path);
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace

void write_scores(OutputFolder& folder, const ScoreReport& report) {
  const fs::path& part = folder.part_path();
  write_matrix(part / "scores.npy", report.table);
  write_hypotheses(part / "hypotheses.csv", report);
  if (report.judged) {
    write_precision_recall(part / "precision_recall.csv", *report.judged, "score");
    const std::string where = report.map.empty() ? report.sequence : report.sequence + " in " + report.map;
    write_png(part / "precision_recall.png", draw_precision_recall(report.table.label + ": " + where, *report.judged));
  }
  write_summary(part / "summary.json", report);
  folder.commit();
}

}  // namespace fabloop
