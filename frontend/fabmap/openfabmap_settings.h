// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/motion_model.h"
#include "frontend/fabmap/place_recognizer.h"
#include "frontend/progress.h"

namespace fabloop {

/// openFABMAP's settings file, all but its `FeatureOptions`, in our terms. What the file leaves out has openFABMAP's own
/// default.
struct OpenFabMapSettings {
  /// `FabMapPlaceAddition`: every image becomes a place, or only one whose likeliest place is a new one.
  enum class PlaceAddition { All, NewMaximumOnly };
  /// `BayesMethod`.
  enum class WordDependence { ChowLiu, NaiveBayes };

  DetectorModel detector;             ///< `PzGe`, `PzGne`.
  PlaceRecognizerOptions recognizer;  ///< `FabMapVersion`, `NewPlaceMethod`, `NumSamples`, `FabMapFBO`'s
                                      ///< `PsGd` and `RejectionThreshold`.
  WordDependence word_dependence = WordDependence::ChowLiu;
  PlaceAddition place_addition = PlaceAddition::All;
  std::optional<MotionModel> motion;  ///< `SimpleMotion`: openFABMAP's, put right (p_new 0.9, reach 1, both ways). None: off.

  int look_up_precision = 6;       ///< `FabMapLUT.Precision`: decimal places of its table.
  double bisection_start = 512.0;  ///< `FabMapFBO.BisectionStart`.
  int num_bisections = 9;          ///< `FabMapFBO.BisectionIts`.

  double radius = 0.45;                 ///< `VocabTrainOptions.ClusterSize`: RadiusClusteringOptions::radius.
  double min_mutual_information = 0.0;  ///< `ChowLiuOptions.LowerInfoBound`: ChowLiuOptions::min_mutual_information.
  std::size_t min_words_per_image = 0;  ///< `BOWOptions.MinWords`: images with fewer words are left out.

  std::string vocabulary_path, tree_path, training_images_path;  ///< `FilePaths`, as they stand there. Empty: not given.
};

/// Reads a settings file. `warn` is told about entries that nothing here uses. Throws InputError naming the file and the entry
/// when it is no settings file or an entry has a value that openFABMAP would not take.
OpenFabMapSettings read_openfabmap_settings(const std::filesystem::path& path, const Warn& warn = {});

/// A settings file for openFABMAP that runs a model's detector on the files that write_openfabmap_model writes beside it.
std::string openfabmap_settings_text(const Model& model, const std::string& matrix_extension = ".yml");

}  // namespace fabloop
