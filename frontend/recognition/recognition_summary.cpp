// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>
#include <vector>

#include "frontend/output_file.h"
#include "frontend/recognition/judged_output.h"
#include "frontend/stage_times.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

Json stage(const std::vector<double>& seconds) { return Json::parse(to_json(stage_times(seconds))); }

Json timings_json(const RecognitionReport& report) {
  std::vector<double> describe_s, words_s, recognize_s;
  double read_s = 0.0;
  for (const ObservedImages* images : {&report.queries, report.map}) {
    if (!images) continue;
    read_s += images->read_s;
    for (const ObservedImage& image : images->images) {
      describe_s.push_back(image.describe_s);
      words_s.push_back(image.words_s);
    }
  }
  for (const RecognizedImage& image : report.recognition.images) recognize_s.push_back(image.recognize_s);
  return {{"read", {{"total_s", read_s}}},
          {"features", stage(describe_s)},
          {"words", stage(words_s)},
          {"recognise", stage(recognize_s)}};
}

Json images_json(const ObservedImages& images) {
  const auto num_without_words = std::count_if(images.images.begin(), images.images.end(),
                                               [](const ObservedImage& image) { return image.observation.words.empty(); });
  return {{"images", images.images.size()}, {"damaged", images.damaged_frames.size()}, {"without_words", num_without_words}};
}

Json options_json(const RecognitionOptions& options) {
  const AppearanceSlamOptions& slam = options.slam;
  return {{"engine", to_string(slam.recognizer.engine)},
          {"new_place", to_string(slam.recognizer.new_place)},
          {"max_samples", slam.recognizer.max_samples},
          {"revisit", to_string(slam.revisit)},
          {"min_revisit_probability", slam.min_revisit_probability},
          {"p_new", slam.motion.p_new},
          {"p_teleport", slam.motion.p_teleport},
          {"reach", slam.motion.reach},
          {"p_forward", slam.motion.p_forward},
          {"trust", slam.trust},
          {"window", options.num_recent_excluded},
          {"top", options.max_matches}};
}

Json model_json(const Model& model) {
  return {{"features", to_string(model.features.kind)},
          {"max_features", model.features.max_features},
          {"words", model.vocabulary.num_words()},
          {"p_seen_if_present", model.detector.p_seen_if_present},
          {"p_seen_if_absent", model.detector.p_seen_if_absent},
          {"background_images", model.background.size()},
          {"training_images", model.provenance.num_images},
          {"training_seed", model.provenance.seed}};
}

}  // namespace

NewPlaceFigures new_place_figures(const Recognition& recognition) {
  NewPlaceFigures figures;
  constexpr double kHalf = 0.5;
  for (const RecognizedImage& image : recognition.images) {
    figures.mean_p_new += image.p_new / static_cast<double>(recognition.images.size());
    figures.num_probably_new += image.p_new > kHalf;
  }
  return figures;
}

void write_recognition_summary(const std::filesystem::path& path, const RecognitionReport& report) {
  const NewPlaceFigures figures = new_place_figures(report.recognition);
  Json summary;
  summary["sequence"] = report.queries.name;
  summary["map"] = report.map ? Json(report.map->name) : Json(nullptr);
  summary["seed"] = report.options.slam.recognizer.seed;
  summary["frames"] = images_json(report.queries);
  summary["map_frames"] = report.map ? images_json(*report.map) : Json(nullptr);
  summary["places"] = report.recognition.places.size();
  summary["mean_p_new"] = figures.mean_p_new;
  summary["probably_new"] = figures.num_probably_new;
  summary["precision_recall"] = judged_json(report.judged, "log_odds");
  summary["options"] = options_json(report.options);
  summary["model"] = model_json(report.model);
  summary["versions"] = {{"fabloop", FABLOOP_VERSION}, {"opencv", CV_VERSION}};
  summary["timings"] = timings_json(report);
  OutputFile file(path);
  file.stream() << summary.dump(2) << '\n';
  file.commit();
}

}  // namespace fabloop
