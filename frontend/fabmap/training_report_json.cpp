// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "frontend/error.h"
#include "frontend/fabmap/training_report.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

/// Calls `visit(name, number)` for every figure, in the order in which they stand in the file.
template <typename Report, typename Visitor>
void for_each_figure(Report& report, Visitor&& visit) {
  visit("images", report.num_images);
  visit("images_without_words", report.num_images_without_words);
  visit("descriptors", report.num_descriptors);
  visit("words", report.num_words);
  visit("words_never_seen", report.num_words_never_seen);
  visit("words_always_seen", report.num_words_always_seen);
  visit("words_in_one_image", report.num_words_in_one_image);
  visit("min_words_per_image", report.min_words_per_image);
  visit("median_words_per_image", report.median_words_per_image);
  visit("max_words_per_image", report.max_words_per_image);
  visit("mean_words_per_image", report.mean_words_per_image);
  visit("mutual_information_nats", report.mutual_information);
  visit("entropy_nats", report.entropy);
  visit("distance_to_word", report.distance_to_word);
  visit("distance_between_words", report.distance_between_words);
  visit("held_out_images", report.self_test.num_held_out);
  visit("held_out_tree_nats", report.self_test.tree_log_likelihood);
  visit("held_out_naive_bayes_nats", report.self_test.naive_bayes_log_likelihood);
  visit("recall_queries", report.self_test.num_recall_queries);
  visit("recalled", report.self_test.num_recalled);
  visit("neighbour_queries", report.self_test.num_neighbour_queries);
  visit("neighbours_first", report.self_test.num_neighbours_first);
}

Json json_of(const TrainingReport& report) {
  Json json;
  for_each_figure(report, [&](const char* name, const auto& number) { json[name] = number; });
  return json;
}

const char* to_string(Grade grade) {
  switch (grade) {
    case Grade::Good:
      return "good";
    case Grade::Fair:
      return "fair";
    case Grade::Poor:
      return "poor";
  }
  return "";
}

}  // namespace

std::string to_json(const TrainingReport& report) { return json_of(report).dump(); }

TrainingReport training_report_from_json(const std::string& text) {
  TrainingReport report;
  try {
    const Json json = Json::parse(text);
    for_each_figure(report, [&](const char* name, auto& number) { json.at(name).get_to(number); });
  } catch (const Json::exception&) {
    throw InputError("a health report that cannot be understood");
  }
  return report;
}

std::string to_json_with_findings(const TrainingReport& report) {
  Json json = json_of(report);
  for (const Finding& finding : findings(report)) {
    json["findings"].push_back({{"grade", to_string(finding.grade)}, {"figure", finding.figure}, {"verdict", finding.verdict}});
  }
  return json.dump(1) + '\n';
}

}  // namespace fabloop
