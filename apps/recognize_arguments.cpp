// SPDX-License-Identifier: BSD-3-Clause
#include "apps/recognize_arguments.h"

#include <filesystem>
#include <string>

namespace fabloop::apps {
namespace {

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
  command->add_option(
      "--window", arguments.window,
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

void add_recognize_arguments(CLI::App* command, RecognizeArguments& arguments) {
  add_input_options(command, arguments);
  add_method_options(command, arguments);
  add_output_options(command, arguments);
}

}  // namespace fabloop::apps
