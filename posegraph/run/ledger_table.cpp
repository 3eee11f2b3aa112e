// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/ledger_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "frontend/csv_lines.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

void require_columns(const CsvFields& head, const CsvFail& fail) {
  for (const char* name : {"query", "match", "probability", "verdict", "matches", "inliers", "has_scale", "tx", "ty", "tz", "qx",
                           "qy", "qz", "qw"}) {
    if (std::find(head.begin(), head.end(), name) == head.end()) fail("the head line has no column '" + std::string(name) + "'");
  }
}

/// The pose of a line that has one: a unit quaternion and a translation that is not zero.
std::optional<Pose> pose_of(const LedgerTable& table, const LedgerRow& row) {
  constexpr double kMaxQuaternionNormError = 1e-2;
  const auto value = [&](const char* column) { return table.figure(row, column).value_or(0.0); };
  const Eigen::Vector3d translation(value("tx"), value("ty"), value("tz"));
  const Eigen::Quaterniond rotation(value("qw"), value("qx"), value("qy"), value("qz"));
  if (std::abs(rotation.norm() - 1.0) > kMaxQuaternionNormError) return std::nullopt;
  // A verification that found no pose leaves the identity behind.
  if (translation.isZero(0.0) && !row.loop.accepted()) return std::nullopt;
  return Pose{rotation.normalized(), translation};
}

LedgerRow read_row(const LedgerTable& table, const CsvFields& fields, const CsvFail& fail) {
  LedgerRow row;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    row.figures.push_back(number_in(fields[i]));
    if (table.columns[i] == "query") row.loop.query = parse_position(fields[i], fail);
    if (table.columns[i] == "match") row.loop.match = parse_position(fields[i], fail);
    if (table.columns[i] == "verdict") row.loop.verdict = fields[i];
  }
  row.loop.has_scale = table.figure(row, "has_scale") == 1.0;
  row.loop.match_from_query = pose_of(table, row);
  if (row.loop.accepted() && !row.loop.match_from_query) fail("an accepted loop has no pose");
  return row;
}

}  // namespace

std::optional<double> LedgerTable::figure(const LedgerRow& row, std::string_view column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) return std::nullopt;
  return row.figures.at(static_cast<std::size_t>(found - columns.begin()));
}

bool leads_into_earlier_map(const LedgerTable& table, const LedgerRow& row) {
  return table.figure(row, "session") != table.figure(row, "match_session");
}

LedgerTable read_ledger(const std::filesystem::path& path, LedgerRows wanted) {
  LedgerTable table;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (table.columns.empty()) {
      require_columns(fields, fail);
      table.columns = fields;
      return;
    }
    if (fields.size() != table.columns.size()) {
      fail("has " + std::to_string(fields.size()) + " columns, but the head line has " + std::to_string(table.columns.size()));
    }
    LedgerRow row = read_row(table, fields, fail);
    if (wanted == LedgerRows::All || !leads_into_earlier_map(table, row)) table.rows.push_back(std::move(row));
  });
  if (table.columns.empty())
    throw InputError(path.string() + ": has no head line; write query,match,probability,verdict,... first");
  return table;
}

}  // namespace fabloop
