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

void add_input_options(CLI::App* command, RecognizeArguments& arguments) {
  command->add_option("SEQUENCE", arguments.sequence, "folder with the images (itself or in images/), or a video")->required();
  command->add_option("--model", arguments.model, "model of `fabloop train`; all methods but seqslam and files need one");
  command
      ->add_option(
          "--method", arguments.method,
          "fabmap; naive-bayes: without the tree; to compare with: tf-idf (DBoW2's L1 score), vlad (intra-normalised), seqslam "
          "(SeqSLAM-style, not the authors' code), or FILE.csv with lines query,match,score of any other method")
      ->check([](const std::string& name) {
        return place_method_named(name) || std::filesystem::path(name).extension() == ".csv"
                   ? std::string()
                   : "there is no method '" + name +
                         "'; give fabmap, naive-bayes, tf-idf, vlad, seqslam or a .csv file of scores";
      })
      ->capture_default_str();
  command->add_option("--map", arguments.map,
                      "another sequence or video: its images become the places among which SEQUENCE is looked up");
  command->add_option("--out", arguments.out, "folder to write to")->required();
  command->add_option("--every", arguments.source.every, "take only every Nth image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rate", arguments.source.max_images_per_s, "take at most so many images a second of the sequence's time")
      ->check(CLI::PositiveNumber);
  command->add_flag("--panorama", arguments.panorama, "the images show 360 degrees: their left and right edges are neighbours");
  command->add_flag("--strict", arguments.strict, "stop at an image that cannot be read instead of skipping it");
  command->add_flag("--overwrite", arguments.overwrite, "replace the folder if it exists");
}

void add_method_options(CLI::App* command, RecognizeArguments& arguments) {
  AppearanceSlamOptions& slam = arguments.options.slam;
  const auto probability = [&](const char* name, double& value, const char* what) {
    command->add_option(name, value, what)->check(CLI::Range(0.0, 1.0))->capture_default_str();
  };
  command
      ->add_option("--new-place", arguments.new_place,
                   "likelihood of a new place: mean-field; sampled, which needs a model of other places; off, where the camera "
                   "is known to be at one of the map's")
      ->check(CLI::IsMember({"mean-field", "sampled", "off"}))
      ->capture_default_str();
  command->add_option("--samples", slam.recognizer.max_samples, "with sampled: at most so many views of elsewhere")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--engine", arguments.engine, "way to the likelihoods: exact, table, bail-out, index")
      ->check([](const std::string& name) {
        return likelihood_engine_from_string(name) ? std::string()
                                                   : "there is no engine '" + name + "'; give exact, table, bail-out or index";
      })
      ->capture_default_str();
  command
      ->add_option("--revisit", arguments.revisit, "whether an image of a known place joins it: never, most-probable, threshold")
      ->check(CLI::IsMember({"never", "most-probable", "threshold"}))
      ->capture_default_str();
  probability("--min-revisit-probability", slam.min_revisit_probability, "with threshold: least probability of the place");
  probability("--p-new", slam.motion.p_new, "prior probability of a new place");
  probability("--p-teleport", slam.motion.p_teleport, "prior probability of being anywhere, not near the last place");
  probability("--p-forward", slam.motion.p_forward, "part of the moves that go the way the route was travelled");
  command->add_option("--reach", slam.motion.reach, "furthest move between two images, in places")->capture_default_str();
  probability("--trust", slam.trust, "trust in each belief; the rest is spread over all places");
  command->add_flag("--naive-bayes", arguments.naive_bayes, "take the words as independent: the tree without its links");
  command->add_option("--p-seen-if-present", arguments.p_seen_if_present,
                      "how surely a word that is there is seen (default: the model's)");
  command->add_option("--p-seen-if-absent", arguments.p_seen_if_absent,
                      "how often a word is seen that is not there (default: the model's)");
  command->add_option("--seed", slam.recognizer.seed, "another number: other samples")->capture_default_str();
}

void add_output_options(CLI::App* command, RecognizeArguments& arguments) {
  command->add_option("--window", arguments.window,
                      "how many of the latest places are left out (default: 10; with --map none, and not for tf-idf, vlad, seqslam)");
  command->add_option("--top", arguments.options.max_matches, "how many places to list for each image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--float64", arguments.float64, "matrices of 64-bit numbers instead of 32-bit ones");
  command->add_option("--truth", arguments.truth,
                      "judge by: a folder with pairs.csv or reference.tum, a pairs.csv, a loop matrix (.npy, text), a TUM file");
  command->add_option("--map-truth", arguments.map_truth, "with --map and poses: the map's poses in the same world frame");
  PoseRules& poses = arguments.truth_options.poses;
  command->add_option("--radius", poses.radius_m, "by poses: centres closer than this, in metres, are true matches")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--not-judged-radius", poses.not_judged_radius_m,
                      "by poses: up to this, matches are neither right nor wrong");
  command->add_option("--max-angle", poses.max_angle_deg, "by poses: optical axes further apart, in degrees, are false matches");
  command
      ->add_option("--max-time-difference", arguments.truth_options.max_time_difference_s,
                   "seconds between an image and its pose")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--every-match", arguments.every_match, "judge all listed places of each image, not the best alone");
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
  add_input_options(command, *arguments);
  add_method_options(command, *arguments);
  add_output_options(command, *arguments);
  command->callback([arguments, command, &common] {
    require_fitting_options(*command, *arguments);
    run_recognize(*arguments, common);
  });
}

}  // namespace fabloop::apps
