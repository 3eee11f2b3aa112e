// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/openfabmap_settings.h"

#include <gmock/gmock.h>

#include "frontend/fabmap/openfabmap_io.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Settings = OpenFabMapSettings;

constexpr const char* kSettings = R"(%YAML:1.0
FilePaths:
   TrainPath: "C:\\fabmap\\train.avi"
   Vocabulary: "vocabulary.yml"
   ChowLiuTree: "tree.yml"
   TrainImagDesc: "bow.yml"
Function: "RunOpenFABMAP"
FeatureOptions:
   DetectorType: "SURF"
BOWOptions:
   MinWords: 12
VocabTrainOptions:
   ClusterSize: 0.3
ChowLiuOptions:
   LowerInfoBound: 0.0005
FabMapPlaceAddition: "NewMaximumOnly"
openFabMapOptions:
   PzGe: 0.45
   PzGne: 0
   NewPlaceMethod: "Sampled"
   NumSamples: 3000
   BayesMethod: "Naive"
   SimpleMotion: 1
   FabMapVersion: "FABMAPFBO"
   FabMapLUT:
      Precision: 4
   FabMapFBO:
      RejectionThreshold: 1e-5
      PsGd: 1e-7
      BisectionStart: 256
      BisectionIts: 8
)";

class OpenFabMapSettingsFile : public ::testing::Test {
 protected:
  Settings read(const std::string& text) {
    return read_openfabmap_settings(folder_.write("settings.yml", text),
                                    [&](const std::string& message) { warnings_.push_back(message); });
  }
  std::string error_of(const std::string& options) {
    return input_error_of([&] { read("%YAML:1.0\nopenFabMapOptions:\n   " + options + "\n"); });
  }

  TemporaryFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(OpenFabMapSettingsFile, IsReadInOurTerms) {
  const Settings settings = read(kSettings);
  EXPECT_EQ(settings.detector.p_seen_if_present, 0.45);
  EXPECT_EQ(settings.detector.p_seen_if_absent, 0.0);
  EXPECT_EQ(settings.recognizer.new_place, NewPlaceModel::Sampled);
  EXPECT_EQ(settings.recognizer.max_samples, 3000u);
  EXPECT_EQ(settings.recognizer.engine, LikelihoodEngine::BailOut);
  EXPECT_EQ(settings.recognizer.bail_out.p_drop_best, 1e-7);
  EXPECT_EQ(settings.recognizer.bail_out.negligible, 1e-5);
  EXPECT_EQ(settings.word_dependence, Settings::WordDependence::NaiveBayes);
  EXPECT_EQ(settings.place_addition, Settings::PlaceAddition::NewMaximumOnly);
  ASSERT_TRUE(settings.motion);
  EXPECT_EQ(settings.motion->p_new, 0.9);
  EXPECT_EQ(settings.look_up_precision, 4);
  EXPECT_EQ(settings.bisection_start, 256.0);
  EXPECT_EQ(settings.num_bisections, 8);
  EXPECT_EQ(settings.radius, 0.3);
  EXPECT_EQ(settings.min_mutual_information, 0.0005);
  EXPECT_EQ(settings.min_words_per_image, 12u);
  EXPECT_EQ(settings.tree_path, "tree.yml");
}

TEST_F(OpenFabMapSettingsFile, NamesWhatIsNotUsed) {
  read(kSettings);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], HasSubstr("settings.yml: not used: FilePaths.TrainPath, Function"));
  EXPECT_THAT(warnings_[0], Not(HasSubstr("FeatureOptions"))) << "these are read elsewhere";
}

TEST_F(OpenFabMapSettingsFile, HasDefaultsForWhatIsLeftOut) {
  const Settings settings = read("%YAML:1.0\nopenFabMapOptions:\n   FabMapVersion: \"FABMAP1\"\n");
  EXPECT_EQ(settings.detector.p_seen_if_present, 0.39);
  EXPECT_EQ(settings.recognizer.engine, LikelihoodEngine::Exact);
  EXPECT_FALSE(settings.motion);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(OpenFabMapSettingsFile, NamesTheBadEntry) {
  EXPECT_THAT(error_of("PzGe: 1.5"), HasSubstr("settings.yml"));
  EXPECT_THAT(error_of("PzGe: \"high\""), HasSubstr("openFabMapOptions.PzGe is not a number"));
  EXPECT_THAT(error_of("FabMapVersion: \"FABMAP3\""),
              HasSubstr("FabMapVersion is \"FABMAP3\"; openFABMAP knows FABMAP2, FABMAP1"));
  EXPECT_THAT(error_of("NumSamples: -1"), HasSubstr("NumSamples is not a whole number"));
  EXPECT_THAT(error_of("FabMapVersion: 1"), HasSubstr("FabMapVersion is not a text"));
}

TEST_F(OpenFabMapSettingsFile, IsWrittenBesideAModel) {
  Model model;
  model.tree = fabloop::testing_support::random_tree(6, 0.3, 1);
  model.vocabulary.words = cv::Mat::ones(6, 4, CV_32F);
  model.background = fabloop::testing_support::TreeSampler(model.tree, 1).draw(3);
  model.detector = {0.6, 0.02};
  write_openfabmap_model(folder_.path() / "model", model);
  const Settings settings = read_openfabmap_settings(folder_.path() / "model" / "settings.yml");
  EXPECT_EQ(settings.detector.p_seen_if_present, 0.6);
  EXPECT_EQ(settings.detector.p_seen_if_absent, 0.02);
  EXPECT_EQ(settings.recognizer.new_place, NewPlaceModel::Sampled);
  EXPECT_EQ(settings.vocabulary_path, "vocabulary.yml");
  EXPECT_EQ(settings.training_images_path, "bow.yml");
}

}  // namespace
}  // namespace fabloop
