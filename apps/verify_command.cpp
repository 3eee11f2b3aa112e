// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/output_file.h"
#include "frontend/recognition/plot.h"
#include "frontend/sequence/camera_yaml.h"
#include "frontend/sequence/sequence.h"
#include "verification/picture/pair_picture.h"
#include "verification/picture/pair_report.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct VerifyArguments {
  std::string query, match;
  std::string camera, match_camera;
  std::optional<double> height, match_height;
  std::string out, picture;
  FeatureArguments features;
  VerifierOptions verifier;
  bool as_json = false;
  bool overwrite = false;
};

/// One image, and what geometry sees of it.
struct SeenView {
  cv::Mat gray;
  View view;
};

SeenView see(std::size_t frame, const std::string& image, const std::string& camera_file, const FeatureExtractor& extractor) {
  const Camera camera = read_camera_yaml(camera_file);
  SeenView seen{read_gray_image(image, camera), {}};
  seen.view = make_view(frame, camera, extractor.extract(seen.gray));
  return seen;
}

/// The pose in words.
std::string pose_text(const Verification& found) {
  const Pose& pose = found.match_from_query;
  if (!(pose.translation.norm() > 0)) return "";
  const Eigen::AngleAxisd turn(pose.rotation);
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "pose of A in B: turned by " << deg_from_rad(turn.angle()) << " degrees about ("
       << turn.axis().x() << ", " << turn.axis().y() << ", " << turn.axis().z() << "), moved "
       << (found.has_scale ? "by (" : "along (") << pose.translation.x() << ", " << pose.translation.y() << ", "
       << pose.translation.z() << (found.has_scale ? ")" : "), how far is not known");
  return text.str();
}

void print_for_people(const VerifyArguments& arguments, const Verification& found, const std::vector<PairFigure>& figures) {
  std::cout << arguments.query << " (A) and " << arguments.match << " (B)\n"
            << to_string(found.verdict) << ": " << meaning_of(found.verdict) << "\n";
  if (const std::string pose = pose_text(found); !pose.empty()) std::cout << pose << "\n";
  std::cout << "\n";
  for (const PairFigure& figure : figures) {
    const auto passed = figure.is_passed();
    std::cout << "  " << std::left << std::setw(20) << figure.name << std::right << std::setw(10) << value_text(figure) << "  "
              << std::left << std::setw(17) << wanted_text(figure) << std::setw(6) << (passed ? (*passed ? "ok" : "FAILS") : "")
              << figure.explanation << "\n";
  }
  std::cout << "\n'-': not known, because a gate before it was not passed\n";
}

ordered_json pose_json(const Verification& found) {
  const Pose& pose = found.match_from_query;
  return {{"translation", {pose.translation.x(), pose.translation.y(), pose.translation.z()}},
          {"rotation_xyzw", {pose.rotation.x(), pose.rotation.y(), pose.rotation.z(), pose.rotation.w()}}};
}

ordered_json to_json(const VerifyArguments& arguments, const Verification& found, const std::vector<PairFigure>& figures) {
  ordered_json json = {{"query", arguments.query},
                       {"match", arguments.match},
                       {"verdict", to_string(found.verdict)},
                       {"meaning", meaning_of(found.verdict)},
                       {"has_scale", found.has_scale}};
  json["match_from_query"] = found.match_from_query.translation.norm() > 0 ? pose_json(found) : ordered_json();
  ordered_json of_figures = ordered_json::object();
  for (const PairFigure& figure : figures) {
    ordered_json one = {{"value", figure.value ? ordered_json(*figure.value) : ordered_json()}};
    if (figure.wanted == PairFigure::Wanted::AtLeast) one["at_least"] = figure.threshold;
    if (figure.wanted == PairFigure::Wanted::AtMost) one["at_most"] = figure.threshold;
    if (const auto passed = figure.is_passed()) one["passed"] = *passed;
    of_figures[std::string(figure.name)] = std::move(one);
  }
  json["figures"] = std::move(of_figures);
  return json;
}

void write_results(const VerifyArguments& arguments, const cv::Mat& picture, const ordered_json& json) {
  if (!arguments.picture.empty()) write_png(arguments.picture, picture);
  if (arguments.out.empty()) return;
  OutputFolder folder(arguments.out, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  write_png(folder.part_path() / "pair.png", picture);
  OutputFile file(folder.part_path() / "verification.json");
  file.stream() << json.dump(2) << '\n';
  file.commit();
  folder.commit();
}

void run_verify(const VerifyArguments& arguments) {
  if (!arguments.out.empty()) {  // before the work, not after it
    const OutputFolder probe(arguments.out,
                             arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  }
  const FeatureExtractor extractor(asked_features(arguments.features));
  const std::string& match_camera = arguments.match_camera.empty() ? arguments.camera : arguments.match_camera;
  SeenView query = see(1, arguments.query, arguments.camera, extractor);
  SeenView match = see(0, arguments.match, match_camera, extractor);
  query.view.height_above_ground = arguments.height;
  match.view.height_above_ground = arguments.match_height;
  const Verification found = Verifier(arguments.verifier).verify(query.view, match.view);
  const std::vector<PairFigure> figures = pair_figures(query.view, match.view, found, arguments.verifier);
  const ordered_json json = to_json(arguments, found, figures);
  if (!arguments.out.empty() || !arguments.picture.empty()) {
    const auto matches = match_features(query.view.features, match.view.features, arguments.verifier.matching);
    std::vector<std::string> remarks = {std::string(meaning_of(found.verdict))};
    if (const std::string pose = pose_text(found); !pose.empty()) remarks.push_back(pose);
    const auto name = [](const std::string& path) { return fs::path(path).filename().string(); };
    write_results(arguments,
                  draw_pair({query.view, match.view, query.gray, match.gray, name(arguments.query), name(arguments.match),
                             matches, found, remarks, figures}),
                  json);
  }
  if (arguments.as_json) {
    std::cout << json.dump(2) << '\n';
  } else {
    print_for_people(arguments, found, figures);
  }
}

void add_verifier_options(CLI::App* command, VerifierOptions& options) {
  command->add_option("--max-ratio", options.matching.max_ratio, "ratio test: largest distance of a match over the second best's")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--min-matches", options.min_matches, "least matches worth a RANSAC")->capture_default_str();
  command->add_option("--min-inliers", options.min_inliers, "least inliers of a loop")->capture_default_str();
  command
      ->add_option("--max-error-px", options.max_error_px,
                   "largest epipolar error of an inlier, in pixels of the image as its features were found")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--guided", options.guided, "more matches along the epipolar lines of a pose that is proven but uncertain");
  command->add_option("--seed", options.seed, "another number: other samples")->capture_default_str();
}

}  // namespace

void add_verify_command(CLI::App& program) {
  const auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* command = program.add_subcommand("verify", "Whether two images show one place, why, and a picture of it");
  command->add_option("A", arguments->query, "the image in question")->required();
  command->add_option("B", arguments->match, "the image it may match: the pose is that of A in B")->required();
  command->add_option("--camera", arguments->camera, "calibration file of the camera (ROS, OpenCV, Kalibr, EuRoC)")->required();
  command->add_option("--camera-b", arguments->match_camera, "that of B's camera, where it is another one");
  command
      ->add_option("--height", arguments->height, "metres that A's camera was above the ground: the scale, where that is a plane")
      ->check(CLI::PositiveNumber);
  command->add_option("--height-b", arguments->match_height, "the same of B's camera; either will do")
      ->check(CLI::PositiveNumber);
  command->add_option("--picture", arguments->picture,
                      "PNG file to draw to: inliers green, rejected matches red, and epipolar lines");
  command->add_option("--out", arguments->out, "folder to write pair.png and verification.json to");
  command->add_flag("--json", arguments->as_json, "print the verdict and its figures as JSON");
  command->add_flag("--overwrite", arguments->overwrite, "replace the folder if it exists");
  add_feature_arguments(command, arguments->features, "");
  add_verifier_options(command, arguments->verifier);
  command->callback([arguments] { run_verify(*arguments); });
}

}  // namespace fabloop::apps
