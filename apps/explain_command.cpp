// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/run_files.h"
#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/recognition/plot.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/evaluation/explanation.h"
#include "posegraph/run/inlier_file.h"
#include "posegraph/run/run_parameters.h"
#include "verification/matching/word_matching.h"
#include "verification/picture/pair_picture.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ExplainArguments {
  fs::path run;
  std::size_t query = 0, match = 0;
  fs::path sequence, camera, model, picture;
};

/// One of the two images, as the run saw it.
struct SeenImage {
  cv::Mat gray;
  View view;
};

SeenImage see(const ExplainArguments& arguments, std::size_t frame, const std::string& name, const FeatureExtractor& extractor) {
  const fs::path camera_file = arguments.camera.empty() ? arguments.sequence / "camera.yaml" : arguments.camera;
  const fs::path folder = fs::is_directory(arguments.sequence / "images") ? arguments.sequence / "images" : arguments.sequence;
  const Camera camera = read_camera_yaml(camera_file);
  SeenImage seen{read_gray_image(folder / name, camera), {}};
  seen.view = make_view(frame, camera, extractor.extract(seen.gray));
  return seen;
}

/// The feature at each pixel.
std::map<std::pair<float, float>, int> features_by_pixel(const View& view) {
  std::map<std::pair<float, float>, int> index;
  for (std::size_t i = 0; i < view.features.keypoints.size(); ++i) {
    const cv::Point2f& pixel = view.features.keypoints[i].pt;
    index.emplace(std::pair(pixel.x, pixel.y), static_cast<int>(i));
  }
  return index;
}

/// The run's own inliers, as features of the two views. Throws InputError when the images do not have them.
std::vector<Match> inliers_of_run(const ExplainArguments& arguments, const View& query, const View& match) {
  const InlierPixels inliers = read_inliers(arguments.run / "inliers.npy");
  const auto found = inliers.find({arguments.query, arguments.match});
  std::vector<Match> matches;
  if (found == inliers.end()) return matches;
  const auto of_query = features_by_pixel(query), of_match = features_by_pixel(match);
  for (const PixelPair& pair : found->second) {
    const auto q = of_query.find({pair.query.x, pair.query.y}), m = of_match.find({pair.match.x, pair.match.y});
    if (q == of_query.end() || m == of_match.end()) {
      throw InputError(arguments.sequence.string() +
                       ": its images do not have the features that the run saw; is it the sequence of " + arguments.run.string() +
                       "?");
    }
    matches.push_back({q->second, m->second});
  }
  return matches;
}

bool matched_by_words(const ordered_json& parameters) {
  return parameters.value("verifier", ordered_json::object()).value("match_by", "features") == std::string("words");
}

/// What the run compared: all features, or those of one visual word, which the model tells. None where it is not given.
std::vector<Match> matches_of(const ExplainArguments& arguments, const ordered_json& parameters, const Features& query,
                              const Features& match) {
  const VerifierOptions options = verifier_options_from_parameters(parameters.dump());
  if (!matched_by_words(parameters)) return match_features(query, match, options.matching);
  if (arguments.model.empty()) return {};
  const Model model = read_model(arguments.model);
  require_features(model, features_from_parameters(parameters.dump()));
  const WordFinder words(model.vocabulary);
  WordMatchingOptions of_words = options.word_matching;
  of_words.matching = options.matching;
  return match_shared_words(query, words.nearest_words(query.descriptors), match, words.nearest_words(match.descriptors),
                            of_words);
}

void draw(const ExplainArguments& arguments, const Explanation& explanation, const ordered_json& parameters,
          const std::vector<std::string>& names) {
  if (arguments.sequence.empty()) throw InputError("--picture needs the images and their camera: give --sequence FOLDER");
  const FeatureExtractor extractor(features_from_parameters(parameters.dump()));
  const SeenImage query = see(arguments, arguments.query, names.at(arguments.query), extractor);
  const SeenImage match = see(arguments, arguments.match, names.at(arguments.match), extractor);
  Verification found = explanation.found;
  found.inliers = inliers_of_run(arguments, query.view, match.view);
  const auto matches = matches_of(arguments, parameters, query.view.features, match.view.features);
  std::vector<std::string> remarks = explanation.words;
  if (matched_by_words(parameters) && arguments.model.empty())
    remarks.emplace_back("The run matched by words: its other matches are drawn with its model (--model).");
  if (explanation.verdict) remarks.insert(remarks.begin(), std::string(meaning_of(*explanation.verdict)));
  write_png(arguments.picture, draw_pair({query.view, match.view, query.gray, match.gray, names.at(arguments.query),
                                          names.at(arguments.match), matches, found, remarks, explanation.gates}));
}

void print_gates(const std::vector<PairFigure>& gates) {
  std::cout << '\n';
  for (const PairFigure& figure : gates) {
    const auto passed = figure.is_passed();
    std::cout << "  " << std::left << std::setw(20) << figure.name << std::right << std::setw(10) << value_text(figure) << "  "
              << std::left << std::setw(17) << wanted_text(figure) << std::setw(6) << (passed ? (*passed ? "ok" : "FAILS") : "")
              << figure.explanation << '\n';
  }
}

void print_hypotheses(const LedgerTable& ledger, const Explanation& explanation) {
  std::cout << "\nall hypotheses of image " << explanation.query
            << "\n  match  appearance   matches   inliers    p_true  verdict\n";
  for (const LedgerRow* row : explanation.of_query) {
    const auto text = [&](const char* column) { return value_text({"", "", ledger.figure(*row, column)}); };
    std::cout << (row->loop.match == explanation.match ? "* " : "  ") << std::right << std::setw(5) << row->loop.match
              << std::setw(12) << text("probability") << std::setw(10) << text("matches") << std::setw(10) << text("inliers")
              << std::setw(10) << text("p_true") << "  " << row->loop.verdict << '\n';
  }
}

void run_explain(const ExplainArguments& arguments) {
  if (!arguments.model.empty() && arguments.picture.empty()) {
    throw InputError("--model is for the matches of a picture: give --picture FILE.png, or leave it out");
  }
  const LedgerTable ledger = read_ledger(arguments.run / "loops.csv");
  const std::vector<std::string> names = read_frame_names(arguments.run);
  if (std::max(arguments.query, arguments.match) >= names.size()) {
    throw InputError((arguments.run / "frames.csv").string() + ": has " + std::to_string(names.size()) +
                     " frames, counted from 0; there is no " + std::to_string(std::max(arguments.query, arguments.match)));
  }
  const ordered_json parameters = read_summary(arguments.run).value("parameters", ordered_json::object());
  ExplainOptions options;
  options.verifier = verifier_options_from_parameters(parameters.dump());
  const ordered_json hypotheses = parameters.value("hypotheses", ordered_json::object());
  options.num_recent_excluded = hypotheses.value("num_recent_excluded", options.num_recent_excluded);
  const Explanation explanation = explain(ledger, arguments.query, arguments.match, options);
  std::cout << "image " << arguments.query << " (" << names[arguments.query] << "), a loop to image " << arguments.match << " ("
            << names[arguments.match] << ")?\n";
  if (explanation.verdict) std::cout << to_string(*explanation.verdict) << ": " << meaning_of(*explanation.verdict) << ".\n";
  for (const std::string& sentence : explanation.words) std::cout << sentence << '\n';
  if (!explanation.gates.empty()) print_gates(explanation.gates);
  if (!explanation.of_query.empty()) print_hypotheses(ledger, explanation);
  if (arguments.picture.empty()) return;
  draw(arguments, explanation, parameters, names);
  std::cout << "\nlook at:     " << arguments.picture.string() << '\n';
}

}  // namespace

void add_explain_command(CLI::App& program) {
  const auto arguments = std::make_shared<ExplainArguments>();
  CLI::App* command = program.add_subcommand("explain", "Why a pair of images of a run did or did not become a loop");
  command->add_option("RUN", arguments->run, "folder that a run wrote")->required();
  command->add_option("QUERY", arguments->query, "the later image: its position in the sequence, from 0")->required();
  command->add_option("MATCH", arguments->match, "the earlier image")->required();
  command->add_option("--picture", arguments->picture, "PNG file to draw the pair to: inliers green, other matches red");
  command->add_option("--sequence", arguments->sequence, "folder of the run's images, for the picture");
  command->add_option("--model", arguments->model, "the run's model, to draw what it matched by words (--match-by words)");
  command->add_option("--camera", arguments->camera, "calibration file (default: camera.yaml in that folder)");
  command->callback([arguments] { run_explain(*arguments); });
}

}  // namespace fabloop::apps
