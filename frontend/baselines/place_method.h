// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fabloop {

/// Ways to say how much an image looks like each place. FAB-MAP is the one that this library is about; the others are what it is
/// compared with. Sources in this folder's README.
enum class PlaceMethod {
  FabMap,      ///< FAB-MAP with its Chow-Liu tree: see PlaceRecognizer.
  NaiveBayes,  ///< FAB-MAP with words that are taken as independent.
  TfIdf,       ///< Bags of words: see tf_idf.h.
  Vlad,        ///< Aggregated residuals: see vlad.h.
  SeqSlam,     ///< Sequences of small images: see sequence_matching.h.
};

/// "fabmap", "naive-bayes", "tf-idf", "vlad", "seqslam": the names of options and tables.
std::string_view to_string(PlaceMethod method);

/// The method of that name; none for other text.
std::optional<PlaceMethod> place_method_named(std::string_view name);

/// What it is, in a few words, so that nobody takes it for its authors' own program.
std::string label_of(PlaceMethod method);

/// All of them, in the order of the enumeration.
std::vector<PlaceMethod> all_place_methods();

/// Whether it looks at a model's words; the others need no model.
bool needs_model(PlaceMethod method);

/// Whether its scores are the log odds of probabilities.
bool is_probabilistic(PlaceMethod method);

}  // namespace fabloop
