// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using test::ScratchFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kWhole = R"(title: Aliasing
data:
  synthetic: {length_m: 300, camera_scale: 0.5}
  seeds: [1, 7]
set: {consistency: 2, blurred_frames: 0.1}
sweep:
  aliasing: [0, 0.3]
  top: [5, 10]
methods: [fabmap, tf-idf, {name: mine, scores: "{seed}-{aliasing}-{blurred_frames}.csv"}]
stages: [back end, appearance, geometry, consistency]
back_ends: [map, gnc-truncated]
features: {max_features: 400}
bootstrap: {resamples: 50, seed: 3, confidence: 0.9}
)";

LabDescription read(const std::string& text) {
  const ScratchFolder folder;
  return read_lab_description(folder.write("lab.yaml", text));
}

std::string error_of(const std::string& text) {
  return test::message_of<InputError>([&] { read(text); });
}

/// The whole description with one line changed.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kWhole;
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(LabDescription, ThoseOfThisRepositoryAreRead) {
  std::size_t num_read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FABLOOP_SOURCE_DIR "/data/lab")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_FALSE(read_lab_description(entry.path()).methods.empty()) << entry.path();
    ++num_read;
  }
  EXPECT_GT(num_read, 5U);
}

TEST(LabDescription, IsReadWhole) {
  const LabDescription lab = read(kWhole);
  EXPECT_EQ(lab.title, "Aliasing");
  ASSERT_TRUE(lab.synthetic.has_value());
  EXPECT_EQ(lab.synthetic->length_m, 300);
  EXPECT_EQ(lab.synthetic->camera_scale, 0.5);
  EXPECT_EQ(lab.synthetic->spacing_m, 4) << "what is not named keeps its default";
  EXPECT_THAT(lab.seeds, ElementsAre(1, 7));
  EXPECT_EQ(lab.settings.consistency, 2);
  EXPECT_EQ(lab.settings.trouble.blurred_frames, 0.1);
  ASSERT_EQ(lab.sweep.size(), 2u);
  EXPECT_EQ(lab.sweep[0].parameter->name, "aliasing");
  EXPECT_THAT(lab.sweep[1].values, ElementsAre(5, 10));
  ASSERT_EQ(lab.methods.size(), 3u);
  EXPECT_EQ(lab.methods[1].method, PlaceMethod::TfIdf);
  EXPECT_FALSE(lab.methods[2].method.has_value());
  EXPECT_THAT(lab.stages, ElementsAre(Stage::Appearance, Stage::Geometry, Stage::Consistency, Stage::BackEnd));
  EXPECT_FALSE(lab.back_ends[0].back_end.has_value());
  EXPECT_EQ(lab.back_ends[1].back_end, BackEnd::GncTruncated);
  EXPECT_EQ(lab.features.max_features, 400);
  EXPECT_EQ(lab.evaluation.bootstrap.num_resamples, 50u);
  EXPECT_TRUE(lab.verifies());
}

TEST(LabDescription, AKeyThatIsNotKnownIsNamedWithItsLine) {
  EXPECT_THAT(error_of(with("title:", "titel:")),
              AllOf(HasSubstr("lab.yaml:1: 'titel' is no key of the description"), HasSubstr("title")));
  EXPECT_THAT(error_of(with("length_m", "lenght_m")), HasSubstr("lab.yaml:3: 'lenght_m' is no key of synthetic"));
  EXPECT_THAT(error_of(with("blurred_frames", "blured_frames")), HasSubstr("lab.yaml:5: 'blured_frames' is no key of set"));
  EXPECT_THAT(error_of(with("aliasing:", "aliassing:")), HasSubstr("lab.yaml:7: 'aliassing' is no key of sweep"));
  EXPECT_THAT(error_of(with("max_features", "max_feature")), HasSubstr("lab.yaml:12: "));
  EXPECT_THAT(error_of(with("resamples", "resample")), HasSubstr("lab.yaml:13: 'resample' is no key of bootstrap"));
}

TEST(LabDescription, AValueThatIsNoneIsNamedWithItsLine) {
  EXPECT_THAT(error_of(with("300", "long")), HasSubstr("lab.yaml:3: 'long' is no number for length_m"));
  EXPECT_THAT(error_of(with("[0, 0.3]", "[0, 1.5]")), HasSubstr("lab.yaml:7: aliasing is 1.5, but must be in [0, 0.95]"));
  EXPECT_THAT(error_of(with("[5, 10]", "[5, 9.5]")), HasSubstr("lab.yaml:8: top must be a whole number"));
  EXPECT_THAT(error_of(with("[5, 10]", "10")), HasSubstr("lab.yaml:8: top must be a list"));
  EXPECT_THAT(error_of(with("[1, 7]", "[1, -7]")), HasSubstr("lab.yaml:4: '-7' is no whole number"));
  EXPECT_THAT(error_of(with("tf-idf", "dbow")), HasSubstr("lab.yaml:9: there is no method 'dbow'"));
  EXPECT_THAT(error_of(with("appearance", "apearance")), HasSubstr("lab.yaml:10: there is no stage 'apearance'"));
  EXPECT_THAT(error_of(with("gnc-truncated", "gnc")), HasSubstr("lab.yaml:11: there is no back end 'gnc'"));
  EXPECT_THAT(error_of("title: [\n"), HasSubstr("lab.yaml"));
}

TEST(LabDescription, WhatComesTwiceIsRefused) {
  EXPECT_THAT(error_of(with("blurred_frames: 0.1", "consistency: 1")),
              HasSubstr("lab.yaml:5: 'consistency' is set or swept twice"));
  EXPECT_THAT(error_of(with("  top: [5, 10]", "  consistency: [1, 2]")),
              HasSubstr("lab.yaml:8: 'consistency' is set or swept twice"));
  EXPECT_THAT(error_of(with("[5, 10]", "[5, 5]")), HasSubstr("lab.yaml:8: a value comes twice"));
  EXPECT_THAT(error_of(with("[1, 7]", "[1, 1]")), HasSubstr("lab.yaml:4: a seed comes twice"));
  EXPECT_THAT(error_of(with("tf-idf", "fabmap")), HasSubstr("lab.yaml:9: the method 'fabmap' comes twice"));
  EXPECT_THAT(error_of(with("gnc-truncated", "map")), HasSubstr("lab.yaml:11: the back end 'map' comes twice"));
}

TEST(LabDescription, WhatDoesNotFitTogetherIsRefused) {
  EXPECT_THAT(error_of("data: {synthetic: {}}\nmethods: [fabmap]\n"), HasSubstr("has no stages"));
  EXPECT_THAT(error_of("data: {synthetic: {}}\nstages: [appearance]\n"), HasSubstr("has no methods"));
  EXPECT_THAT(error_of("methods: [fabmap]\nstages: [appearance]\n"), HasSubstr("has no data"));
  EXPECT_THAT(error_of("data: {seeds: [1]}\n"), HasSubstr("lab.yaml:1: data must be either synthetic or sequences"));
  EXPECT_THAT(error_of(with("back_ends: [map, gnc-truncated]", "")), HasSubstr("add back_ends"));
  EXPECT_THAT(error_of(with("back end, ", "")), HasSubstr("no stage 'back end'"));
  EXPECT_THAT(error_of(with("consistency: 2, ", "")), HasSubstr("off by default"));
  EXPECT_THAT(error_of(with("  synthetic: {length_m: 300, camera_scale: 0.5}", "  sequences: [{folder: a}]")),
              HasSubstr("only synthetic worlds"));
  EXPECT_THAT(error_of(with("name: mine", "name: vlad")), HasSubstr("the name of a built-in method"));
}

TEST(LabDescription, AFileOfScoresIsOfOneSequenceOfImages) {
  EXPECT_THAT(error_of(with("-{aliasing}", "")),
              HasSubstr("lab.yaml:9: the scores of 'mine' are of other images where 'aliasing'"));
  EXPECT_THAT(error_of(with("-{blurred_frames}", "")), HasSubstr("with {blurred_frames} in the path"));
  EXPECT_THAT(error_of(with("{seed}-", "")), HasSubstr("with {seed} in the path"));
  const std::string flights = "data: {sequences: [{folder: a}, {folder: b}]}\nstages: [appearance]\n";
  EXPECT_THAT(error_of(flights + "methods: [{name: mine, scores: mine.csv}]\n"),
              HasSubstr("lab.yaml:3: the scores of 'mine' are of other images with every sequence"));
  const std::string dropped = flights + "set: {dropped_frames: 0.2}\n";
  EXPECT_THAT(error_of(dropped + "methods: [{name: mine, scores: \"{data}.csv\"}]\n"),
              HasSubstr("lab.yaml:4: the scores of 'mine' are of other images where 'dropped_frames'"));
  EXPECT_THAT(
      error_of("data: {sequences: [{folder: a, earlier: b}]}\nstages: [appearance]\nmethods: [{name: mine, scores: mine.csv}]\n"),
      HasSubstr("lab.yaml:3: the scores of 'mine' are of one sequence"));
  // What is done with the scores leaves the images alone.
  EXPECT_EQ(read(flights + "sweep: {top: [5, 10]}\nmethods: [{name: mine, scores: \"{data}.csv\"}]\n").methods.size(), 1u);
}

TEST(LabDescription, EveryParameterIsThereUnderItsNameAndStartsWithinItsRange) {
  for (const LabParameter& parameter : lab_parameters()) {
    EXPECT_EQ(lab_parameter(parameter.name), &parameter) << "two parameters are called " << parameter.name;
    LabSettings settings;
    EXPECT_GE(parameter.of(settings), parameter.low) << parameter.name;
    EXPECT_LE(parameter.of(settings), parameter.high) << parameter.name;
  }
  EXPECT_EQ(lab_parameter("no such"), nullptr);
}

}  // namespace
}  // namespace fabloop
