// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/cell_file.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "frontend/error.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

/// JSON knows no infinity, which is a possible score.
Json number_json(double value) {
  if (std::isfinite(value)) return value;
  return value > 0.0 ? "inf" : "-inf";
}

double number_of(const Json& json) {
  if (json.is_number()) return json;
  const auto text = json.get<std::string>();
  if (text != "inf" && text != "-inf") throw InputError("'" + text + "' is no number");
  return text == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::optional<double> optional_of(const Json& json) { return json.is_null() ? std::nullopt : std::optional(json.get<double>()); }

/// "true", "false" or none, as a letter.
std::string truth_text(MatchTruth truth) { return truth == MatchTruth::True ? "t" : truth == MatchTruth::False ? "f" : "-"; }

MatchTruth truth_of(const Json& json) {
  const auto text = json.get<std::string>();
  if (text == "t") return MatchTruth::True;
  if (text == "f") return MatchTruth::False;
  if (text == "-") return MatchTruth::NotJudged;
  throw InputError("'" + text + "' is no truth");
}

Json run_json(const JudgedRun& run) {
  Json queries = Json::array(), hypotheses = Json::array();
  for (const QueryTruth& query : run.queries) queries.push_back({query.frame, query.num_true_pairs, query.num_false_pairs});
  for (const JudgedHypothesis& h : run.hypotheses) {
    hypotheses.push_back({h.query, h.match, h.num_stages_passed, number_json(h.score), optional_json(h.probability),
                          h.num_matches, optional_json(h.p_true), truth_text(h.place), truth_text(h.closure)});
  }
  return {{"recipe", run.recipe},
          {"has_consistency", run.has_consistency},
          {"query_columns", {"frame", "true_pairs", "false_pairs"}},
          {"queries", queries},
          {"hypothesis_columns",
           {"query", "match", "stages_passed", "score", "probability", "matches", "p_true", "place", "closure"}},
          {"hypotheses", hypotheses}};
}

JudgedRun run_of(const Json& json) {
  JudgedRun run;
  run.recipe = json.at("recipe");
  run.has_consistency = json.at("has_consistency");
  for (const Json& query : json.at("queries")) run.queries.push_back({query.at(0), query.at(1), query.at(2)});
  for (const Json& row : json.at("hypotheses")) {
    JudgedHypothesis h;
    h.query = row.at(0);
    h.match = row.at(1);
    h.num_stages_passed = row.at(2);
    h.score = number_of(row.at(3));
    h.probability = optional_of(row.at(4));
    h.num_matches = row.at(5);
    h.p_true = optional_of(row.at(6));
    h.place = truth_of(row.at(7));
    h.closure = truth_of(row.at(8));
    run.hypotheses.push_back(h);
  }
  return run;
}

Json trial_json(const BackEndTrial& trial) {
  Json loops = Json::array();
  for (const TriedLoop& loop : trial.loops)
    loops.push_back({loop.query, loop.match, loop.is_kept, loop.is_injected, truth_text(loop.truth)});
  return {{"name", trial.name},
          {"ate_m", optional_json(trial.ate_m)},
          {"loop_columns", {"query", "match", "kept", "injected", "truth"}},
          {"loops", loops}};
}

BackEndTrial trial_of(const Json& json) {
  BackEndTrial trial;
  trial.name = json.at("name");
  trial.ate_m = optional_of(json.at("ate_m"));
  for (const Json& row : json.at("loops")) {
    TriedLoop loop;
    loop.query = row.at(0);
    loop.match = row.at(1);
    loop.is_kept = row.at(2);
    loop.is_injected = row.at(3);
    loop.truth = truth_of(row.at(4));
    trial.loops.push_back(loop);
  }
  return trial;
}

Json trouble_json(const TroubledSequence& trouble) {
  return {{"frames", trouble.num_frames},   {"dropped", trouble.num_dropped},   {"blurred", trouble.num_blurred},
          {"exposed", trouble.num_exposed}, {"occluded", trouble.num_occluded}, {"steps", trouble.num_steps},
          {"slips", trouble.num_slips}};
}

TroubledSequence trouble_of(const Json& json) {
  TroubledSequence trouble;
  trouble.num_frames = json.at("frames");
  trouble.num_dropped = json.at("dropped");
  trouble.num_blurred = json.at("blurred");
  trouble.num_exposed = json.at("exposed");
  trouble.num_occluded = json.at("occluded");
  trouble.num_steps = json.at("steps");
  trouble.num_slips = json.at("slips");
  return trouble;
}

CellResult result_of(const Json& json) {
  CellResult result;
  result.num_frames = json.at("frames");
  result.aliased_share = json.at("aliased_share");
  result.trouble = trouble_of(json.at("trouble"));
  result.odometry_ate_m = optional_of(json.at("odometry_ate_m"));
  for (const Json& of_method : json.at("methods")) {
    MethodResult method{of_method.at("name"), of_method.at("label"), run_of(of_method), {}};
    for (const Json& trial : of_method.at("back_ends")) method.back_ends.push_back(trial_of(trial));
    result.methods.push_back(std::move(method));
  }
  return result;
}

}  // namespace

void write_cell(const std::filesystem::path& path, const std::string& checksum, const LabCell& cell, const CellResult& result) {
  Json swept = Json::object();
  for (const auto& [name, value] : cell.swept) swept[name] = value;
  Json methods = Json::array();
  for (const MethodResult& method : result.methods) {
    Json json = {{"name", method.name}, {"label", method.label}};
    json.update(run_json(method.run));
    json["back_ends"] = Json::array();
    for (const BackEndTrial& trial : method.back_ends) json["back_ends"].push_back(trial_json(trial));
    methods.push_back(std::move(json));
  }
  const Json json = {{"checksum", checksum},
                     {"data", cell.data},
                     {"seed", cell.seed},
                     {"swept", swept},
                     {"frames", result.num_frames},
                     {"aliased_share", result.aliased_share},
                     {"trouble", trouble_json(result.trouble)},
                     {"odometry_ate_m", optional_json(result.odometry_ate_m)},
                     {"methods", methods}};
  OutputFile file(path);
  file.stream() << json.dump() << '\n';
  file.commit();
}

std::optional<CellResult> read_cell(const std::filesystem::path& path, const std::string& checksum) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const Json json = Json::parse(file);
    if (json.at("checksum") != checksum) throw InputError("is the result of another cell");
    return result_of(json);
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": " + error.what() + "; remove the file, and it is made again");
  }
}

}  // namespace fabloop
