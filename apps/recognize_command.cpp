// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/progress_bar.h"
#include "apps/recognize_arguments.h"
#include "apps/run_report.h"
#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/recognition/recognition_folder.h"
#include "frontend/recognition/recognition_summary.h"
#include "frontend/recognition/recognition_truth.h"

namespace fabloop::apps {
namespace {

Model read_adjusted_model(const RecognizeArguments& arguments) {
  Model model = read_model(arguments.model);
  if (arguments.naive_bayes) model = naive_bayes(std::move(model));
  if (arguments.p_seen_if_present) model.detector.p_seen_if_present = *arguments.p_seen_if_present;
  if (arguments.p_seen_if_absent) model.detector.p_seen_if_absent = *arguments.p_seen_if_absent;
  validate(model.detector, "--p-seen-if-present and --p-seen-if-absent");
  return model;
}

ObservedImages observe_source(const std::string& path, const Model& model, const RecognizeArguments& arguments,
                              const CommonOptions& common) {
  ImageSource source(path, arguments.source);
  return observe_images(source, model,
                        {.shape = arguments.panorama ? ImageShape::Panorama : ImageShape::Plain,
                         .num_threads = common.num_threads,
                         .progress = arguments.options.progress});
}

/// A map of another time has no recent places; within one sequence, the window of the truth is that of the recogniser.
void settle_window(RecognizeArguments& arguments) {
  const std::size_t within_sequence = arguments.window.value_or(RecognitionOptions{}.num_recent_excluded);
  arguments.options.num_recent_excluded = arguments.map.empty() ? within_sequence : arguments.window.value_or(0);
  arguments.truth_options.exclusion_window = within_sequence;
}

std::string percent(double part) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << 100.0 * part << " %";
  return text.str();
}

void print_report(const RecognitionReport& report, const std::string& out) {
  const std::size_t num_images = report.recognition.images.size();
  const NewPlaceFigures figures = new_place_figures(report.recognition);
  std::cout << "images:  " << num_images << " recognised";
  if (!report.queries.damaged_frames.empty()) std::cout << ", " << report.queries.damaged_frames.size() << " damaged";
  std::cout << "\nplaces:  " << report.recognition.places.size();
  if (report.map) std::cout << " from " << report.map->images.size() << " images of " << report.map->name;
  std::cout << "\nnew:     " << figures.num_probably_new << " images are more likely at a new place than not; mean probability "
            << percent(figures.mean_p_new) << '\n';
  if (report.judged) print_judged(*report.judged);
  std::cout << "look at: " << out << "/posterior.png, " << out << "/summary.json\n";
}

void run_recognize(RecognizeArguments& arguments, const CommonOptions& common) {
  const auto method = place_method_named(arguments.method);
  arguments.naive_bayes = arguments.naive_bayes || method == PlaceMethod::NaiveBayes;
  arguments.options.progress = make_progress(common);
  settle_window(arguments);
  arguments.judging.scored = arguments.every_match ? Scored::EveryMatch : Scored::BestOfQuery;
  arguments.source.if_damaged = arguments.strict ? IfDamaged::Refuse : IfDamaged::Skip;
  arguments.source.num_threads = common.num_threads;
  arguments.source.warn = make_warn(common);
  if (!method || !is_probabilistic(*method)) {
    run_recognize_scores(arguments, common);
    return;
  }
  RecognitionFolder folder(arguments.out, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse,
                           arguments.float64 ? NpyType::Float64 : NpyType::Float32);
  const Model model = read_adjusted_model(arguments);
  RecognitionOptions& options = arguments.options;
  options.slam.recognizer.engine = *likelihood_engine_from_string(arguments.engine);
  options.slam.recognizer.new_place = *new_place_model_from_string(arguments.new_place);
  options.slam.revisit = *revisit_from_string(arguments.revisit);
  options.warn = make_warn(common);
  options.on_row = folder.on_row();

  std::optional<ObservedImages> map;
  if (!arguments.map.empty()) map = observe_source(arguments.map, model, arguments, common);
  const ObservedImages queries = observe_source(arguments.sequence, model, arguments, common);
  std::optional<GroundTruth> truth;
  if (!arguments.truth.empty()) {
    truth = map ? read_truth_in_map(arguments.truth, queries.images, arguments.map_truth, map->images, arguments.truth_options)
                : read_truth(arguments.truth, queries.images, arguments.truth_options);
  }
  const Recognition recognition =
      map ? recognize_in_map(model, map->images, queries.images, options) : recognize_sequence(model, queries.images, options);
  std::optional<PrecisionRecall> judged;
  if (truth) judged = evaluate_recognition(scored_queries(recognition), recognition.places, *truth, arguments.judging);
  const RecognitionReport report{
      model, options, queries, map ? &*map : nullptr, recognition, truth ? &*truth : nullptr, judged ? &*judged : nullptr};
  folder.finish(report);
  print_report(report, arguments.out);
}

/// What only FAB-MAP knows.
constexpr std::array<const char*, 16> kFabMapOptions = {"--new-place",
                                                        "--samples",
                                                        "--engine",
                                                        "--revisit",
                                                        "--min-revisit-probability",
                                                        "--p-new",
                                                        "--p-teleport",
                                                        "--p-forward",
                                                        "--reach",
                                                        "--trust",
                                                        "--seed",
                                                        "--float64",
                                                        "--p-seen-if-present",
                                                        "--p-seen-if-absent",
                                                        "--naive-bayes",
                                                        "--panorama"};

/// Throws wrong usage for a model that is missing, and for options that the method would not look at.
void require_fitting_options(const CLI::App& command, const RecognizeArguments& arguments) {
  const auto method = place_method_named(arguments.method);
  if (method && needs_model(*method) && arguments.model.empty()) throw CLI::RequiredError("--model");
  if (method && is_probabilistic(*method)) return;
  for (const char* option : kFabMapOptions) {
    if (command.count(option) > 0) throw CLI::ExcludesError(option, "--method " + arguments.method);
  }
  // Within a map nothing is recent to these.
  if (method && !arguments.map.empty() && command.count("--window") > 0)
    throw CLI::ExcludesError("--window", "--map and --method " + arguments.method);
}

}  // namespace

void print_judged(const PrecisionRecall& judged) {
  if (judged.curve) {
    std::cout << "average precision:           " << percent(judged.curve->average_precision) << '\n'
              << "recall at 100 % precision:   " << percent(judged.curve->recall_at_full_precision) << '\n';
    for (const RecallAt& at : judged.recall_at) {
      std::cout << std::left << std::setw(29) << "recall@" + std::to_string(at.k) + ":" << percent(at.recall) << '\n';
    }
  } else {
    std::cout << "no query has a true match, so there is no recall\n";
  }
  std::cout << "by these rules: " << judged.recipe << '\n';
}

void add_recognize_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<RecognizeArguments>();
  CLI::App* command =
      program.add_subcommand("recognize", "Which earlier image, or which of another sequence, shows the same place");
  add_recognize_arguments(command, *arguments);
  command->callback([arguments, command, &common] {
    require_fitting_options(*command, *arguments);
    run_recognize(*arguments, common);
  });
}

}  // namespace fabloop::apps
