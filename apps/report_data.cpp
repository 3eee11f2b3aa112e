// SPDX-License-Identifier: BSD-3-Clause
#include "apps/report_data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/report_images.h"
#include "apps/report_map.h"
#include "apps/run_files.h"
#include "apps/stage_report.h"
#include "frontend/error.h"
#include "posegraph/evaluation/stage_trajectories.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/run/inlier_file.h"
#include "posegraph/run/run_parameters.h"
#include "verification/picture/pair_report.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// As many digits as a reader can use.
double shortened(double value) {
  constexpr int kDigits = 6;
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value, std::chars_format::general, kDigits).ptr;
  std::from_chars(text, end, value);
  return value;
}

/// A list a column, without the pose's digits that nobody reads.
ordered_json ledger_data(const LedgerTable& ledger) {
  ordered_json columns = ordered_json::object();
  for (std::size_t c = 0; c < ledger.columns.size(); ++c) {
    const std::string& name = ledger.columns[c];
    ordered_json values = ordered_json::array();
    for (const LedgerRow& row : ledger.rows) {
      if (name == "verdict") {
        values.push_back(row.loop.verdict);
      } else if (row.figures[c]) {
        values.push_back(shortened(*row.figures[c]));
      } else {
        values.push_back(nullptr);
      }
    }
    columns[name] = std::move(values);
  }
  return columns;
}

/// "true", "false: pose", ... a row; what a loop is, or, where it has no pose, what its pair is.
ordered_json judgements(const LedgerTable& ledger, const JudgedRun& judged, const LoopTruth& truth,
                        const LoopEvaluationOptions& options) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < ledger.rows.size(); ++i) {
    const JudgedHypothesis& hypothesis = judged.hypotheses[i];
    ordered_json one = {{"place", static_cast<int>(hypothesis.place)}, {"closure", static_cast<int>(hypothesis.closure)}};
    if (ledger.rows[i].loop.match_from_query) {
      const JudgedLoop loop = judge_loop(ledger.rows[i].loop, truth, options);
      if (loop.judgement != LoopJudgement::NoReference) {
        one["rotation_error_deg"] = shortened(loop.rotation_error_deg);
        if (ledger.rows[i].loop.has_scale) one["translation_error_m"] = shortened(loop.translation_error_m);
        if (!ledger.rows[i].loop.has_scale) one["direction_error_deg"] = shortened(loop.direction_error_deg);
      }
    }
    list.push_back(std::move(one));
  }
  return list;
}

/// A run without a unit is judged in the reference's.
Alignment alignment_of(const RunKind& kind) { return kind.has_unit ? Alignment::Se3 : Alignment::Sim3; }

ordered_json errors(const fs::path& run, const Trajectory& reference, Alignment alignment) {
  ordered_json list = ordered_json::array();
  for (const auto& [name, file] : {std::pair("odometry", "trajectory_odometry.tum"), std::pair("online", "trajectory_online.tum"),
                                   std::pair("final", "trajectory.tum")}) {
    if (!fs::exists(run / file)) continue;
    const auto ate = absolute_trajectory_error(read_tum(run / file), reference, {.alignment = alignment});
    if (ate) list.push_back({{"name", name}, {"ate_m", ate->translation_m.rmse}, {"max_m", ate->translation_m.max}});
  }
  return list;
}

ordered_json truth_data(const ReportInput& input, const RunKind& kind, const RunTruth& truth, const LedgerTable& ledger) {
  const JudgedRun judged = judge_run(ledger, truth.places, truth.loops, input.loops);
  ordered_json data = {{"evaluation", stages_json(evaluate_stages(judged, kind, input.stages))},
                       {"rows", judgements(ledger, judged, truth.loops, input.loops)},
                       {"errors", errors(input.truth.run, truth.reference, alignment_of(kind))}};
  const fs::path graph = input.truth.run / "graph.g2o";
  if (truth.reference.empty() || !fs::exists(graph) || kind.is_from_images) return data;
  for (const StageTrajectory& without : solve_without_stages(read_g2o(graph), ledger, truth.frame_times_ns)) {
    const auto ate = absolute_trajectory_error(without.trajectory, truth.reference);
    if (!ate) continue;
    data["errors"].push_back(
        {{"name", without.name}, {"note", without.note}, {"ate_m", ate->translation_m.rmse}, {"max_m", ate->translation_m.max}});
  }
  return data;
}

/// The gates in their order, with the limits of the run; the page fills in each row's figures.
ordered_json gates(const ordered_json& summary) {
  const auto options = verifier_options_from_parameters(summary.value("parameters", ordered_json::object()).dump());
  Verification all;  // one that passed every gate, so that each is listed
  all.planar_lead = 0.0;
  all.has_scale = true;
  ordered_json list = ordered_json::array();
  for (const PairFigure& figure : gate_figures(all, options)) {
    ordered_json one = {{"name", figure.name}, {"explanation", figure.explanation}};
    if (figure.wanted == PairFigure::Wanted::AtLeast) one["at_least"] = figure.threshold;
    if (figure.wanted == PairFigure::Wanted::AtMost) one["at_most"] = figure.threshold;
    list.push_back(std::move(one));
  }
  return list;
}

/// Of a run from images alone, whose pairs are proven by two views and then by the map's points.
ordered_json pair_gates(const ordered_json& summary) {
  const ordered_json limits = summary.value("parameters", ordered_json::object()).value("pairs", ordered_json::object());
  return {{{"name", "matches"}, {"explanation", "features that look alike"}},
          {{"name", "inliers"},
           {"explanation", "matches that agree with a pose of the two views"},
           {"at_least", limits.value("min_inliers", 0)}},
          {{"name", "parallax_deg"}, {"explanation", "angle between the views' rays, rotation undone"}},
          {{"name", "point_inliers"},
           {"explanation", "points of the map that both images show"},
           {"at_least", limits.value("min_shared_points", 0)}},
          {{"name", "rms_error_px"}, {"explanation", "distance of those points from where the query shows them"}}};
}

ordered_json verdicts() {
  ordered_json meanings = ordered_json::object();
  for (int i = 0; i <= static_cast<int>(Verdict::ContradictsMap); ++i) {
    const auto verdict = static_cast<Verdict>(i);
    meanings[std::string(to_string(verdict))] = {{"meaning", meaning_of(verdict)}, {"gate", gate_of(verdict)}};
  }
  return meanings;
}

/// Some inliers of each row, evenly over its list: four 16-bit numbers each, eighths of a pixel.
ordered_json inlier_data(const fs::path& path, const LedgerTable& ledger) {
  if (!fs::exists(path)) return nullptr;
  const InlierPixels inliers = read_inliers(path);
  constexpr std::size_t kMaxBytes = 2'000'000, kBytesAnInlier = 8;
  const std::size_t most =
      std::clamp<std::size_t>(kMaxBytes / kBytesAnInlier / std::max<std::size_t>(1, inliers.size()), 12, 150);
  std::string bytes;
  const auto put = [&](float value) {
    constexpr float kEighths = 8.0F, kMax = 65535.0F;
    const auto number = static_cast<std::uint16_t>(std::lround(std::clamp(value * kEighths, 0.0F, kMax)));
    bytes += static_cast<char>(number & 0xff);
    bytes += static_cast<char>(number >> 8);
  };
  ordered_json counts = ordered_json::array();
  for (const LedgerRow& row : ledger.rows) {
    const auto found = inliers.find({row.loop.query, row.loop.match});
    const std::size_t available = found == inliers.end() ? 0 : found->second.size(), count = std::min(available, most);
    counts.push_back(count);
    for (std::size_t i = 0; i < count; ++i) {
      const PixelPair& pair = found->second[i * available / count];
      for (const float value : {pair.query.x, pair.query.y, pair.match.x, pair.match.y}) put(value);
    }
  }
  return {{"counts", counts}, {"pixels", base64(bytes)}};
}

fs::path image_folder(const ReportInput& input) {
  fs::path folder = input.images;
  if (folder.empty() && fs::is_directory(input.truth.truth)) folder = input.truth.truth;
  return fs::is_directory(folder / "images") ? folder / "images" : folder;
}

ordered_json image_data(const ReportInput& input, const std::vector<std::string>& names) {
  const fs::path folder = image_folder(input);
  if (folder.empty()) return nullptr;
  std::vector<fs::path> paths;
  for (const std::string& name : names) paths.push_back(folder / name);
  ThumbnailOptions options;
  options.num_threads = input.num_threads;
  const Thumbnails thumbnails = make_thumbnails(paths, options);
  if (thumbnails.image_width == 0) {
    if (input.images.empty()) return nullptr;
    throw InputError(folder.string() + ": has none of the images that frames.csv names; give their folder with --images");
  }
  ordered_json jpegs = ordered_json::array();
  for (const std::string& jpeg : thumbnails.jpegs) jpegs.push_back(base64(jpeg));
  return {{"width", thumbnails.image_width}, {"height", thumbnails.image_height}, {"jpegs", jpegs}};
}

}  // namespace

ordered_json report_data(const ReportInput& input) {
  const fs::path& run = input.truth.run;
  ordered_json data;
  data["summary"] = read_summary(run);
  const LedgerTable ledger = read_ledger(run / "loops.csv");
  const std::vector<std::string> names = read_frame_names(run);
  const std::vector<std::int64_t> times_ns = read_frame_times(run / "frames.csv");
  data["frames"] = names;
  RunTruth truth;
  if (!input.truth.truth.empty()) truth = read_run_truth(input.truth);
  const RunKind kind = run_kind(data["summary"]);
  data["map"] = map_data(run, truth.reference, times_ns, alignment_of(kind));
  data["ledger"] = ledger_data(ledger);
  if (kind.is_from_images) {
    for (const char* belief : {"p_new", "probability", "p_true"}) data["ledger"].erase(belief);  // pairs are proposed without one
  }
  data["gates"] = kind.is_from_images ? pair_gates(data["summary"]) : gates(data["summary"]);
  data["verdicts"] = verdicts();
  data["truth"] = input.truth.truth.empty() ? ordered_json(nullptr) : truth_data(input, kind, truth, ledger);
  data["inliers"] = inlier_data(run / "inliers.npy", ledger);
  data["images"] = image_data(input, names);
  return data;
}

}  // namespace fabloop::apps
