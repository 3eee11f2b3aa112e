// SPDX-License-Identifier: BSD-3-Clause
#include "verification/ledger.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

namespace fabloop {
namespace {

LoopEvent event_of_two() {
  LoopEvent event;
  event.query = 31;
  event.session = 1;
  event.p_new = 0.125;
  HypothesisOutcome accepted;
  accepted.match = 4;
  accepted.probability = 1.0 / 3.0;
  accepted.log_likelihood = -std::numeric_limits<double>::infinity();
  accepted.verification.verdict = Verdict::Accepted;
  accepted.verification.num_inliers = 60;
  accepted.verification.has_scale = true;
  accepted.verification.match_from_query.translation = {1.5, -2.25, 0.1};
  HypothesisOutcome rejected;
  rejected.match = 9;
  rejected.match_session = 1;
  event.hypotheses = {accepted, rejected};
  return event;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<std::string> lines_of(const LoopEvent& event, LedgerFormat format) {
  std::ostringstream text;
  write_ledger(text, event, format);
  std::vector<std::string> lines;
  std::istringstream stream(text.str());
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Ledger, BeginsWithTheColumnsOfTheContract) {
  EXPECT_TRUE(ledger_csv_head().starts_with("query,match,probability,verdict,matches,inliers,has_scale,tx,ty,tz,qx,qy,qz,qw,"));
}

TEST(Ledger, CsvAndJsonSayTheSame) {
  const LoopEvent event = event_of_two();
  const auto head = fields_of(ledger_csv_head());
  const auto csv = lines_of(event, LedgerFormat::Csv);
  const auto json = lines_of(event, LedgerFormat::JsonLines);
  ASSERT_EQ(csv.size(), 2U);
  ASSERT_EQ(json.size(), 2U);
  for (std::size_t row = 0; row < csv.size(); ++row) {
    const auto fields = fields_of(csv[row]);
    const auto object = nlohmann::json::parse(json[row]);
    ASSERT_EQ(fields.size(), head.size());
    ASSERT_EQ(object.size(), head.size());
    for (std::size_t i = 0; i < head.size(); ++i) {
      const auto& value = object.at(head[i]);
      if (value.is_null()) {
        EXPECT_TRUE(fields[i].empty() || fields[i] == "-inf") << head[i] << " is " << fields[i];
      } else if (value.is_string()) {
        EXPECT_EQ(fields[i], value.get<std::string>()) << head[i];
      } else {
        EXPECT_EQ(std::stod(fields[i]), value.get<double>()) << head[i];
      }
    }
  }
}

TEST(Ledger, NumbersComeBackExactly) {
  const auto object = nlohmann::json::parse(lines_of(event_of_two(), LedgerFormat::JsonLines).front());
  EXPECT_EQ(object.at("probability"), 1.0 / 3.0);
  EXPECT_EQ(object.at("tz"), 0.1);
  EXPECT_EQ(object.at("verdict"), "Accepted");
  EXPECT_EQ(object.at("session"), 1);
  EXPECT_EQ(object.at("match_session"), 0);
}

TEST(Ledger, AnEventWithoutHypothesesHasNoLine) { EXPECT_TRUE(lines_of(LoopEvent{}, LedgerFormat::Csv).empty()); }

}  // namespace
}  // namespace fabloop
