// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_settings.h"

#include <gmock/gmock.h>

#include "frontend/error.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

/// Options none of which is the default.
FeatureOptions unusual_options() {
  FeatureOptions options;
  options.kind = *feature_kind_from_string("star+sift");
  options.max_features = 777;
  options.detection_threshold = 0.1 + 0.2;
  options.clahe_clip_limit.reset();
  options.root_sift = false;
  options.orientation = Orientation::Upright;
  options.adaptive.emplace().min_features = 123;
  options.star.max_size_px = 45;
  options.mser.max_variation = 1.0 / 3.0;
  options.gftt.min_distance_px = 7;
  options.fast.non_max_suppression = false;
  return options;
}

std::string message_of(const std::filesystem::path& path) {
  try {
    read_feature_settings(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FeatureSettings, ComeBackAsTheyWere) {
  const TemporaryFolder folder;
  for (const FeatureOptions& options : {FeatureOptions{}, unusual_options()}) {
    write_feature_settings(folder.path() / "a.yaml", options);
    const FeatureOptions read = read_feature_settings(folder.path() / "a.yaml");
    EXPECT_EQ(feature_options_json(read), feature_options_json(options));
    EXPECT_EQ(feature_settings_text(read), feature_settings_text(options));
    EXPECT_EQ(feature_options_json(feature_options_from_json(feature_options_json(options))), feature_options_json(options));
  }
}

TEST(FeatureSettings, WhatIsLeftOutHasItsDefault) {
  const TemporaryFolder folder;
  const auto read =
      read_feature_settings(folder.write("a.yaml", "features:\n  kind: fast\n  fast:\n    non_max_suppression: off\n"));
  EXPECT_EQ(to_string(read.kind), "fast+brisk");
  EXPECT_FALSE(read.fast.non_max_suppression);
  EXPECT_EQ(read.max_features, FeatureOptions{}.max_features);
}

TEST(FeatureSettings, MistakesAreNamedWithTheirLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) { return message_of(folder.write("a.yaml", text)); };
  EXPECT_THAT(message("features:\n  kind: sift\n  max_feature: 3\n"), HasSubstr("a.yaml:3: 'max_feature'"));
  EXPECT_THAT(message("features:\n  star:\n    max_size: 3\n"), HasSubstr("a.yaml:3: 'star.max_size'"));
  EXPECT_THAT(message("features:\n  max_features: many\n"), HasSubstr("a.yaml:2: max_features is 'many'; give a whole number"));
  EXPECT_THAT(message("features:\n  max_features: [1, 2]\n"), HasSubstr("a.yaml:2"));
  EXPECT_THAT(message("features:\n  kind: harris\n"), HasSubstr("a.yaml:2: kind is 'harris'"));
  EXPECT_THAT(message("features:\n  star: 3\n"), HasSubstr("a.yaml:2: star is a section"));
  EXPECT_THAT(message("feature:\n  star: 3\n"), HasSubstr("a.yaml:1: 'feature'"));
  EXPECT_THAT(message("features:\n  kind: fast+akaze\n"), HasSubstr("fast+sift"));
  EXPECT_THAT(message("features:\n  star: [\n"), HasSubstr("is no YAML"));
  EXPECT_THAT(message("3"), HasSubstr("holds no settings"));
  EXPECT_THAT(message_of(folder.path() / "missing.yaml"), HasSubstr("missing.yaml"));
  EXPECT_THAT(message_of(folder.path()), HasSubstr("cannot be read"));
}

TEST(FeatureSettings, OneOptionCanBeSetByItsKey) {
  FeatureOptions options;
  set_feature_option(options, "surf.num_octaves", "3");
  set_feature_option(options, "clahe_clip_limit", "none");
  set_feature_option(options, "adaptive.max_features", "444");
  EXPECT_EQ(options.surf.num_octaves, 3);
  EXPECT_FALSE(options.clahe_clip_limit.has_value());
  EXPECT_EQ(options.adaptive->max_features, 444);
  set_feature_option(options, "adaptive", "none");
  EXPECT_FALSE(options.adaptive.has_value());
  EXPECT_THROW(set_feature_option(options, "surf.octaves", "3"), InputError);
  EXPECT_THROW(set_feature_option(options, "surf.num_octaves", "3.5"), InputError);
}

TEST(FeatureSettings, OldModelsJsonIsRead) {
  const FeatureOptions options = feature_options_from_json(
      R"({"kind":"orb","max_features":150,"detection_threshold":null,"clahe_clip_limit":1.5,"root_sift":true})");
  EXPECT_EQ(to_string(options.kind), "orb");
  EXPECT_EQ(options.max_features, 150);
  for (const char* bad : {"", "3", "{\"kind\":\"harris\"}", "{\"kind\":3}", "{\"wings\":2}", "{\"max_features\":1.5}"}) {
    EXPECT_THROW(feature_options_from_json(bad), InputError) << bad;
  }
}

TEST(FeatureSettings, DifferencesCountWhereTheyMatter) {
  const FeatureOptions sift;
  EXPECT_FALSE(first_difference(sift, sift).has_value());
  FeatureOptions other = sift;
  other.mser.delta = 3;
  other.detection_threshold = default_detection_threshold(DetectorKind::Sift);
  EXPECT_FALSE(first_difference(sift, other).has_value());
  other.sift.sigma = 1.2;
  EXPECT_EQ(first_difference(sift, other)->option, "sift.sigma");
  EXPECT_EQ(first_difference(sift, other)->a, "1.6");
  EXPECT_EQ(first_difference(sift, unusual_options())->option, "adaptive");
}

constexpr const char* kOpenFabMap = R"(%YAML:1.0
FilePaths:
   TrainPath: "C:\\video.avi"
FeatureOptions:
   DetectorType: "STAR"
   DetectorMode: "STATIC"
   Adaptive:
      MinFeatures: 300
      MaxFeatures: 500
      MaxIters: 5
   FastDetector:
      Threshold: 50
      NonMaxSuppression: 1
   StarDetector:
      MaxSize: 32 #45
      Response: 10 #30
      LineThreshold: 18 #10
      LineBinarized: 17 #8
      Suppression: 20 #5
   SurfDetector:
      HessianThreshold: 1000 #400
      NumOctaves: 4
      NumOctaveLayers: 2
      Upright: 1
      Extended: 0
   ORB:
      nFeatures: 500
      scaleFactor: 1.2
   ExtractorType: "SURF"
BOWOptions:
   MinWords: 0
)";

TEST(OpenFabMapFeatures, AreRead) {
  const TemporaryFolder folder;
  for (const bool directly : {false, true}) {
    const auto path = folder.write("settings.yml", kOpenFabMap);
    const FeatureOptions options = directly ? read_openfabmap_features(path) : read_feature_settings(path);
    EXPECT_EQ(to_string(options.kind), "star+surf");
    EXPECT_EQ(options.detection_threshold, 10.0);
    EXPECT_EQ(options.star.max_size_px, 65);
    EXPECT_EQ(options.star.line_threshold, 18.0);
    EXPECT_EQ(options.star.line_threshold_scale, 17.0);
    EXPECT_EQ(options.star.suppression_px, 21);
    EXPECT_EQ(options.surf.layers_per_octave, 2);
    EXPECT_EQ(options.orientation, Orientation::Upright);
    EXPECT_FALSE(options.adaptive.has_value());
    EXPECT_FALSE(options.clahe_clip_limit.has_value());
  }
}

TEST(OpenFabMapFeatures, AdaptiveModeIsRead) {
  const TemporaryFolder folder;
  std::string text = kOpenFabMap;
  text.replace(text.find("STATIC"), 6, "ADAPTIVE");
  const FeatureOptions options = read_openfabmap_features(folder.write("settings.yml", text));
  ASSERT_TRUE(options.adaptive.has_value());
  EXPECT_EQ(options.adaptive->min_features, 300);
  EXPECT_EQ(options.adaptive->max_features, 500);
  EXPECT_EQ(options.adaptive->max_iterations, 5);
}

TEST(OpenFabMapFeatures, MistakesAreNamedWithTheirLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& what, const std::string& with) {
    std::string text = kOpenFabMap;
    text.replace(text.find(what), what.size(), with);
    return message_of(folder.write("settings.yml", text));
  };
  EXPECT_THAT(message("Response", "Respons"), HasSubstr("settings.yml:16: 'StarDetector.Respons'"));
  EXPECT_THAT(message("MaxSize: 32", "MaxSize: big"), HasSubstr("settings.yml:15"));
  EXPECT_THAT(message("\"STAR\"", "\"HARRIS\""), HasSubstr("settings.yml:5"));
  EXPECT_THAT(message("STATIC", "DYNAMIC"), HasSubstr("settings.yml:6"));
  EXPECT_THAT(message("Extended: 0", "Extended: 1"), HasSubstr("settings.yml:25"));
  EXPECT_THAT(message("ORB:", "ORBIT:"), HasSubstr("settings.yml:26: 'ORBIT'"));
  EXPECT_THAT(message("ExtractorType", "Extractor"), HasSubstr("ExtractorType"));
  EXPECT_THAT(message("NumOctaves: 4", "NumOctaves: 400"), HasSubstr("surf.num_octaves"));
}

}  // namespace
}  // namespace fabloop
