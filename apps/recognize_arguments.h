// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "apps/command.h"
#include "frontend/baselines/place_method.h"
#include "frontend/recognition/recognition_run.h"
#include "frontend/recognition/recognition_truth.h"

namespace fabloop::apps {

/// What `fabloop recognize` was told.
struct RecognizeArguments {
  std::string sequence, map, model, out;
  std::string truth, map_truth;
  std::string method{to_string(PlaceMethod::FabMap)};  ///< A PlaceMethod's name, or a file of scores.
  ImageSourceOptions source;
  RecognitionOptions options;
  RecognitionTruthOptions truth_options;
  PrecisionRecallOptions judging;
  std::string engine{to_string(LikelihoodEngine::InvertedIndex)};
  std::string new_place{to_string(NewPlaceModel::MeanField)};
  std::string revisit{to_string(Revisit::Never)};
  std::optional<std::size_t> window;
  std::optional<double> p_seen_if_present, p_seen_if_absent;
  bool panorama = false, naive_bayes = false, every_match = false, float64 = false, strict = false, overwrite = false;
};

void add_recognize_arguments(CLI::App* command, RecognizeArguments& arguments);

/// Average precision, recall and the rules, on the standard output.
void print_judged(const PrecisionRecall& judged);

/// Looks the sequence up by a method other than FAB-MAP, and writes its folder of scores.
void run_recognize_scores(const RecognizeArguments& arguments, const CommonOptions& common);

}  // namespace fabloop::apps
