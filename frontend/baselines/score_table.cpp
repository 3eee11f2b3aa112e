// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/score_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "frontend/csv_lines.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kNotFound = -std::numeric_limits<double>::infinity();

constexpr std::array<const char*, 3> kColumns = {"query", "match", "score"};

/// Which field each of kColumns is.
using ScoreLayout = std::array<std::size_t, kColumns.size()>;

ScoreLayout read_head(const CsvFields& head, const CsvFail& fail) {
  ScoreLayout layout{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(head.begin(), head.end(), kColumns[i]);
    if (found == head.end()) fail("the head line has no column '" + std::string(kColumns[i]) + "'; write query,match,score");
    layout[i] = static_cast<std::size_t>(found - head.begin());
  }
  return layout;
}

using PositionOfFrame = std::unordered_map<std::size_t, std::size_t>;

std::size_t position_in(const PositionOfFrame& positions, std::size_t frame, const char* what, const CsvFail& fail) {
  const auto found = positions.find(frame);
  if (found == positions.end()) fail(std::string(what) + " " + std::to_string(frame) + " is no image of the sequence");
  return found->second;
}

}  // namespace

std::vector<ScoredQuery> scored_queries(const ScoreTable& table, std::size_t max_matches) {
  std::vector<ScoredQuery> queries;
  queries.reserve(table.rows.size());
  for (const ScoreRow& row : table.rows) {
    ScoredQuery query{row.frame, row.num_places, {}};
    for (std::size_t place = 0; place < row.scores.size(); ++place) {
      if (row.scores[place] != kNotFound) query.matches.push_back({place, row.scores[place]});
    }
    std::stable_sort(query.matches.begin(), query.matches.end(),
                     [](const ScoredMatch& a, const ScoredMatch& b) { return a.score > b.score; });
    query.matches.resize(std::min(max_matches, query.matches.size()));
    queries.push_back(std::move(query));
  }
  return queries;
}

PrecisionRecall judge_scores(const ScoreTable& table, const GroundTruth& truth, std::size_t max_matches,
                             const PrecisionRecallOptions& options) {
  PlaceFrames places;
  for (const std::size_t frame : table.place_frames) places.push_back({frame});
  return evaluate_recognition(scored_queries(table, max_matches), places, truth, options);
}

ScoreTable empty_scores(const std::vector<std::size_t>& query_frames, const std::vector<std::size_t>& place_frames,
                        bool within_one_sequence, std::size_t num_recent_excluded) {
  ScoreTable table;
  table.place_frames = place_frames;
  for (std::size_t i = 0; i < query_frames.size(); ++i) {
    const std::size_t num_places = within_one_sequence ? i : place_frames.size();
    const std::size_t num_scored = num_places - std::min(num_places, num_recent_excluded);
    table.rows.push_back({query_frames[i], num_places, std::vector<double>(num_scored, kNotFound)});
  }
  return table;
}

void read_scores(const std::filesystem::path& path, ScoreTable& table) {
  PositionOfFrame rows, places;
  for (std::size_t i = 0; i < table.rows.size(); ++i) rows[table.rows[i].frame] = i;
  for (std::size_t i = 0; i < table.place_frames.size(); ++i) places[table.place_frames[i]] = i;
  std::optional<ScoreLayout> layout;
  std::size_t num_columns = 0;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (!layout) {
      layout = read_head(fields, fail);
      num_columns = fields.size();
      return;
    }
    if (fields.size() != num_columns) {
      fail("has " + std::to_string(fields.size()) + " columns, but the head line has " + std::to_string(num_columns));
    }
    const std::size_t query = position_in(rows, parse_position(fields[(*layout)[0]], fail), "query", fail);
    const std::size_t place = position_in(places, parse_position(fields[(*layout)[1]], fail), "match", fail);
    const double score = parse_number(fields[(*layout)[2]], fail);
    std::vector<double>& scores = table.rows[query].scores;
    if (place >= scores.size()) return;
    if (scores[place] != kNotFound) fail("has a pair that came before");
    scores[place] = score;
  });
  if (!layout) throw InputError(path.string() + ": has no head line; write query,match,score first");
  table.label = "scores of " + path.filename().string();
}

}  // namespace fabloop
