// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/place_method.h"

#include <array>

#include "frontend/names.h"

namespace fabloop {
namespace {

constexpr std::array<Named<PlaceMethod>, 5> kMethodNames = {{{PlaceMethod::FabMap, "fabmap"},
                                                       {PlaceMethod::NaiveBayes, "naive-bayes"},
                                                       {PlaceMethod::TfIdf, "tf-idf"},
                                                       {PlaceMethod::Vlad, "vlad"},
                                                       {PlaceMethod::SeqSlam, "seqslam"}}};

constexpr std::array<Named<PlaceMethod>, 5> kLabels = {{{PlaceMethod::FabMap, "FAB-MAP, Chow-Liu tree"},
                                                        {PlaceMethod::NaiveBayes, "FAB-MAP, naive Bayes"},
                                                        {PlaceMethod::TfIdf, "TF-IDF, DBoW2's L1 score"},
                                                        {PlaceMethod::Vlad, "VLAD, intra-normalised"},
                                                        {PlaceMethod::SeqSlam, "SeqSLAM-style, not the authors' code"}}};

}  // namespace

std::string_view to_string(PlaceMethod method) { return name_of(kMethodNames, method); }

std::optional<PlaceMethod> place_method_named(std::string_view name) { return named(kMethodNames, name); }

std::string label_of(PlaceMethod method) { return std::string(name_of(kLabels, method)); }

std::vector<PlaceMethod> all_place_methods() {
  std::vector<PlaceMethod> methods;
  for (const auto& named : kMethodNames) methods.push_back(named.value);
  return methods;
}

bool needs_model(PlaceMethod method) { return method != PlaceMethod::SeqSlam; }

bool is_probabilistic(PlaceMethod method) { return method == PlaceMethod::FabMap || method == PlaceMethod::NaiveBayes; }

}  // namespace fabloop
