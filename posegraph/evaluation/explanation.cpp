// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/explanation.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "frontend/error.h"

namespace fabloop {
namespace {

std::optional<Verdict> verdict_named(const std::string& name) {
  for (int i = 0; i <= static_cast<int>(Verdict::ContradictsMap); ++i) {
    if (name == to_string(static_cast<Verdict>(i))) return static_cast<Verdict>(i);
  }
  return std::nullopt;
}

std::string number(double value) { return value_text({"", "", value}); }

/// Why a pair is not in the ledger.
std::string why_not_verified(const LedgerTable& ledger, const Explanation& explanation, const ExplainOptions& options) {
  std::ostringstream text;
  text << "Never verified: ";
  if (explanation.query - explanation.match <= options.num_recent_excluded) {
    text << "the " << options.num_recent_excluded << " images before a query overlap it anyway and are no loops.";
  } else if (explanation.of_query.empty()) {
    text << "image " << explanation.query << " has no hypotheses: it was not mapped, or nothing before it was far enough back.";
  } else {
    double least = 1.0;
    for (const LedgerRow* row : explanation.of_query) least = std::min(least, ledger.figure(*row, "probability").value_or(0.0));
    text << "by appearance it was not among the " << explanation.of_query.size() << " most probable places of image "
         << explanation.query << ", the last of which has probability " << number(least)
         << ". More hypotheses (map --hypotheses), or a model trained on images like these, may bring it up.";
  }
  return text.str();
}

std::string appearance_words(const LedgerTable& ledger, const LedgerRow& row) {
  std::ostringstream text;
  text << "By appearance this place has probability " << number(ledger.figure(row, "probability").value_or(0.0));
  if (const auto rank = ledger.figure(row, "rank")) text << ", rank " << number(*rank);
  if (const auto p_new = ledger.figure(row, "p_new")) text << "; the image shows a new place with " << number(*p_new);
  return text.str() + ".";
}

std::string back_end_words(const LedgerTable& ledger, const LedgerRow& row) {
  const auto weight = ledger.figure(row, "map_weight"), chi2 = ledger.figure(row, "map_chi2");
  if (!weight || !chi2) return "";
  return "In the map its squared error is " + number(*chi2) + "; the back end believes it with weight " + number(*weight) + ".";
}

/// What would have to be different for the loop to be accepted.
std::string change_words(const Explanation& explanation) {
  const Verdict verdict = *explanation.verdict;
  if (verdict == Verdict::Accepted) return "";
  const auto gate = std::find_if(explanation.gates.begin(), explanation.gates.end(),
                                 [&](const PairFigure& figure) { return figure.name == gate_of(verdict); });
  if (gate != explanation.gates.end() && gate->value) {
    std::ostringstream text;
    text << "To get past this gate, " << gate->name << " (" << gate->explanation << ") would have to be " << wanted_text(*gate)
         << "; it is " << value_text(*gate) << ". The gates after it were not asked.";
    return text.str();
  }
  switch (verdict) {
    case Verdict::NoPose:
      return "Matches that agree with one motion of the camera would be needed; most of these are accidents.";
    case Verdict::ScaleDisagrees:
      return "The points' depths, from either side, would have to tell the same pose as the rays.";
    case Verdict::PoorlyConstrained:
      return "More inliers, further apart, or a longer baseline would be needed: see rotation_sigma_deg and translation_sigma.";
    case Verdict::Unconfirmed:
      return "The next images would have to prove loops nearby that agree with it (map --confirm asks for so many).";
    case Verdict::ContradictsMap:
      return "The other loops and the odometry would have to lead to the pose that these two images show.";
    default:
      return "";
  }
}

}  // namespace

Verification verification_of(const LedgerTable& ledger, const LedgerRow& row) {
  const auto number_of = [&](const char* column) { return ledger.figure(row, column).value_or(0.0); };
  const auto count_of = [&](const char* column) { return static_cast<int>(std::lround(number_of(column))); };
  Verification found;
  found.verdict = verdict_named(row.loop.verdict).value_or(Verdict::NoPose);
  found.p_true = number_of("p_true");
  found.num_looks = std::max(1, count_of("looks"));
  found.num_matches = count_of("matches");
  found.num_inliers = count_of("inliers");
  found.num_true = number_of("true_inliers");
  found.num_point_inliers = count_of("point_inliers");
  found.num_window_inliers = count_of("window_inliers");
  found.log10_false_alarms = number_of("log10_false_alarms");
  found.inlier_area = number_of("inlier_area");
  found.inlier_cells = number_of("inlier_cells");
  found.num_second_inliers = count_of("second_inliers");
  found.planar_lead = ledger.figure(row, "planar_lead");
  found.rotation_share = number_of("rotation_share");
  found.baseline_to_depth = number_of("baseline_to_depth");
  found.median_parallax_deg = number_of("parallax_deg");
  found.rotation_sigma_deg = number_of("rotation_sigma_deg");
  found.translation_sigma = number_of("translation_sigma");
  found.scale_sigma = number_of("scale_sigma");
  found.rms_error_px = number_of("rms_error_px");
  found.num_iterations = count_of("iterations");
  found.has_scale = row.loop.has_scale;
  if (row.loop.match_from_query) found.match_from_query = *row.loop.match_from_query;
  return found;
}

Explanation explain(const LedgerTable& ledger, std::size_t query, std::size_t match, const ExplainOptions& options) {
  if (match >= query) {
    throw InputError("image " + std::to_string(match) + " is not before image " + std::to_string(query) +
                     ": give the later image first, then the earlier one");
  }
  Explanation explanation;
  explanation.query = query;
  explanation.match = match;
  const LedgerRow* found = nullptr;
  for (const LedgerRow& row : ledger.rows) {
    if (row.loop.query != query) continue;
    explanation.of_query.push_back(&row);
    if (row.loop.match == match) found = &row;
  }
  if (!found) {
    explanation.words = {why_not_verified(ledger, explanation, options)};
    return explanation;
  }
  explanation.found = verification_of(ledger, *found);
  explanation.verdict = explanation.found.verdict;
  explanation.gates = gate_figures(explanation.found, options.verifier);
  for (const std::string& sentence :
       {appearance_words(ledger, *found), back_end_words(ledger, *found), change_words(explanation)}) {
    if (!sentence.empty()) explanation.words.push_back(sentence);
  }
  return explanation;
}

}  // namespace fabloop
