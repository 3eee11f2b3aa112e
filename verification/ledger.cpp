// SPDX-License-Identifier: BSD-3-Clause
#include "verification/ledger.h"

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

namespace fabloop {
namespace {

/// Calls `visit(name, value)` for each column of a hypothesis, in their order: the one place where they are listed.
template <typename Visitor>
void for_each_column(const LoopEvent& event, std::size_t index, const HypothesisOutcome& outcome, Visitor&& visit) {
  const Verification& v = outcome.verification;
  const Eigen::Vector3d& t = v.match_from_query.translation;
  const Eigen::Quaterniond& q = v.match_from_query.rotation;
  visit("query", event.query);
  visit("match", outcome.match);
  visit("probability", outcome.probability);
  visit("verdict", to_string(v.verdict));
  visit("matches", v.num_matches);
  visit("inliers", v.num_inliers);
  visit("has_scale", v.has_scale ? 1 : 0);
  visit("tx", t.x());
  visit("ty", t.y());
  visit("tz", t.z());
  visit("qx", q.x());
  visit("qy", q.y());
  visit("qz", q.z());
  visit("qw", q.w());
  visit("rank", index + 1);
  visit("log_likelihood", outcome.log_likelihood);
  visit("p_new", event.p_new);
  visit("point_inliers", v.num_point_inliers);
  visit("log10_false_alarms", v.log10_false_alarms);
  visit("inlier_area", v.inlier_area);
  visit("parallax_deg", v.median_parallax_deg);
  visit("rotation_sigma_deg", v.rotation_sigma_deg);
  visit("translation_sigma", v.translation_sigma);
  visit("rms_error_px", v.rms_error_px);
  visit("iterations", v.num_iterations);
  visit("true_inliers", v.num_true);
  visit("inlier_cells", v.inlier_cells);
  visit("second_inliers", v.num_second_inliers);
  visit("planar_lead", v.planar_lead.value_or(std::numeric_limits<double>::quiet_NaN()));
  visit("rotation_share", v.rotation_share);
  visit("baseline_to_depth", v.baseline_to_depth);
  visit("scale_sigma", v.scale_sigma);
  visit("p_true", v.p_true);
  visit("session", event.session);
  visit("match_session", outcome.match_session);
  visit("map_chi2", outcome.map_chi2.value_or(std::numeric_limits<double>::quiet_NaN()));
  visit("map_weight", outcome.map_weight.value_or(std::numeric_limits<double>::quiet_NaN()));
  visit("looks", v.num_looks);
  visit("window_inliers", v.num_window_inliers);
}

/// As many digits as it takes to get the same number back.
void print(std::ostream& out, double value) {
  std::array<char, 32> text{};
  if (std::isnan(value)) return;  // not known: an empty field
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  out << std::string_view(text.data(), end);
}
void print(std::ostream& out, std::integral auto value) { out << value; }
void print(std::ostream& out, std::string_view value) { out << value; }

void write_csv_line(std::ostream& out, const LoopEvent& event, std::size_t index) {
  bool is_first = true;
  for_each_column(event, index, event.hypotheses[index], [&](const char*, const auto& value) {
    if (!is_first) out << ',';
    is_first = false;
    print(out, value);
  });
  out << '\n';
}

void write_json_line(std::ostream& out, const LoopEvent& event, std::size_t index) {
  nlohmann::ordered_json line;
  for_each_column(event, index, event.hypotheses[index], [&](const char* name, const auto& value) { line[name] = value; });
  out << line.dump() << '\n';
}

}  // namespace

std::string ledger_csv_head() {
  std::string head;
  for_each_column({}, 0, {}, [&](const char* name, const auto&) {
    if (!head.empty()) head += ',';
    head += name;
  });
  return head;
}

void write_ledger(std::ostream& out, const LoopEvent& event, LedgerFormat format) {
  for (std::size_t index = 0; index < event.hypotheses.size(); ++index) {
    (format == LedgerFormat::Csv ? write_csv_line : write_json_line)(out, event, index);
  }
}

}  // namespace fabloop
