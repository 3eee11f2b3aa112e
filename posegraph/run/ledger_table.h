// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posegraph/evaluation/loop_truth.h"

namespace fabloop {

/// A hypothesis with every figure that is known of it.
struct LedgerRow {
  LoopRecord loop;                             ///< With its pose wherever one was found, accepted or not.
  std::vector<std::optional<double>> figures;  ///< One a column of the table; none where the field is empty or no number.
};

/// A run's `loops.csv` with all its columns.
struct LedgerTable {
  std::vector<std::string> columns;  ///< The head line.
  std::vector<LedgerRow> rows;       ///< In the file's order; see LedgerRows.

  /// The figure of that column; none where the row, or the whole file, does not have it.
  std::optional<double> figure(const LedgerRow& row, std::string_view column) const;
};

/// Which lines of a ledger count.
enum class LedgerRows {
  WithinSession,  ///< Those whose match is a frame of this sequence, as in read_loops().
  All,            ///< Also those that led into an earlier map; see leads_into_earlier_map().
};

/// Reads it. Throws InputError naming file and line.
LedgerTable read_ledger(const std::filesystem::path& path, LedgerRows wanted = LedgerRows::WithinSession);

/// Whether the row's match is a frame of an earlier map: its `match_session` is not its `session`.
bool leads_into_earlier_map(const LedgerTable& table, const LedgerRow& row);

}  // namespace fabloop
