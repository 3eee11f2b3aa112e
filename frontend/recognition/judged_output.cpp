// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/judged_output.h"

#include <array>
#include <charconv>

#include "frontend/output_file.h"

namespace fabloop {

std::string exact_text(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

void write_precision_recall(const std::filesystem::path& path, const PrecisionRecall& judged, const std::string& score_name) {
  OutputFile file(path);
  file.stream() << "# " << judged.recipe << "\nthreshold_" << score_name << ",precision,recall\n";
  if (judged.curve) {
    for (const PrecisionRecallPoint& point : judged.curve->points) {
      file.stream() << exact_text(point.threshold) << ',' << exact_text(point.precision) << ',' << exact_text(point.recall)
                    << '\n';
    }
  }
  file.commit();
}

nlohmann::ordered_json judged_json(const PrecisionRecall* judged, const std::string& score_name) {
  using Json = nlohmann::ordered_json;
  if (!judged) return nullptr;
  Json json = {{"recipe", judged->recipe},
               {"queries", judged->num_queries},
               {"queries_with_true_match", judged->num_queries_with_true_match},
               {"decisions", judged->num_decisions}};
  if (!judged->curve) return json;
  const PrecisionRecallCurve& curve = *judged->curve;
  json["positives"] = curve.num_positives;
  json["average_precision"] = curve.average_precision;
  json["area_trapezoidal"] = curve.area_trapezoidal;
  json["recall_at_full_precision"] = curve.recall_at_full_precision;
  json["full_precision_threshold_" + score_name] =
      curve.full_precision_threshold ? Json(*curve.full_precision_threshold) : Json(nullptr);
  for (const RecallAt& at : judged->recall_at) json["recall_at"][std::to_string(at.k)] = at.recall;
  return json;
}

}  // namespace fabloop
