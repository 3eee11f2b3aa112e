// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model_hash.h"
#include "frontend/fabmap/model_training.h"
#include "frontend/fabmap/place_recognizer.h"
#include "tests/support/descriptor_sampling.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

class ModelFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("fabloop_model_") + test->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  fs::remove(path);  // Some file systems wait for the disk when a file is truncated.
  std::ofstream(path, std::ios::binary) << bytes;
}

Model some_model() {
  Model model;
  model.features.kind = {DetectorKind::Akaze, DescriptorKind::Akaze};
  model.features.adaptive.emplace().min_features = 77;
  model.features.akaze.num_octaves = 3;
  model.features.detection_threshold = 0.002;
  model.features.clahe_clip_limit.reset();
  model.tree = testing_support::random_tree(30, 0.2, 1);
  model.vocabulary.words = testing_support::clustered_descriptors(30, 7, 30, 1);
  model.background = testing_support::TreeSampler(model.tree, 1).draw(5);
  model.background.push_back({});
  model.detector = {0.5, 0.01};
  model.provenance = {"0.1.0", "train --seed 7", 7, 100, 123456789012};
  return model;
}

TEST_F(ModelFile, ComesBackAsItWas) {
  const Model model = some_model();
  write_model(path("a"), model);
  const Model read = read_model(path("a"));
  EXPECT_EQ(read.features.kind, model.features.kind);
  EXPECT_EQ(read.features.adaptive->min_features, 77);
  EXPECT_EQ(read.features.akaze.num_octaves, 3);
  EXPECT_EQ(read.features.detection_threshold, model.features.detection_threshold);
  EXPECT_EQ(read.features.clahe_clip_limit, std::nullopt);
  EXPECT_EQ(cv::norm(read.vocabulary.words, model.vocabulary.words, cv::NORM_INF), 0.0);
  EXPECT_EQ(read.tree.nodes[9].parent, model.tree.nodes[9].parent);
  EXPECT_EQ(read.tree.nodes[0].parent, std::nullopt);
  EXPECT_EQ(read.background[2].words, model.background[2].words);
  EXPECT_EQ(read.background.size(), 6u);
  EXPECT_EQ(read.provenance.num_descriptors, 123456789012u);
  write_model(path("b"), read);
  EXPECT_EQ(bytes_of(path("a")), bytes_of(path("b")));
}

TEST_F(ModelFile, KeepsItsWordsWhenTheFileIsReplaced) {
  const Model model = some_model();
  write_model(path("a"), model);
  Vocabulary vocabulary;
  {
    Model read = read_model(path("a"));
    Model other = some_model();
    other.vocabulary.words.setTo(1.0);
    write_model(path("a"), other);
    vocabulary = std::move(read).vocabulary;
  }
  EXPECT_EQ(cv::norm(vocabulary.words, model.vocabulary.words, cv::NORM_INF), 0.0);
  fs::remove(path("a"));
  vocabulary.words.at<float>(0, 0) = 7.0F;
  EXPECT_EQ(vocabulary.words.at<float>(0, 0), 7.0F);
}

TEST_F(ModelFile, IsRefusedWhenTruncatedAnywhere) {
  write_model(path("a"), some_model());
  const std::string bytes = bytes_of(path("a"));
  for (std::size_t size = 0; size < bytes.size(); size += size < 1024 ? 1 : 61) {
    write_bytes(path("b"), bytes.substr(0, size));
    EXPECT_THROW(read_model(path("b")), InputError) << size;
  }
  write_bytes(path("b"), bytes.substr(0, bytes.size() - 1));
  EXPECT_THROW(read_model(path("b")), InputError);
  write_bytes(path("b"), bytes + "x");
  EXPECT_THROW(read_model(path("b")), InputError);
}

TEST_F(ModelFile, IsRefusedOrReadWhenAnyByteIsDamaged) {
  write_model(path("a"), some_model());
  const std::string bytes = bytes_of(path("a"));
  for (std::size_t i = 0; i < bytes.size(); i += i < 1024 ? 1 : 17) {
    for (const char damage : {'\0', '\x7f', '\xff'}) {
      std::string damaged = bytes;
      damaged[i] = damage;
      write_bytes(path("b"), damaged);
      try {
        read_model(path("b"));
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(path("b").string()), std::string::npos) << error.what();
      }
    }
  }
}

TEST_F(ModelFile, IsRefusedWhenMissingOrOfAnotherKindOrVersion) {
  EXPECT_THROW(read_model(path("missing")), InputError);
  EXPECT_THROW(read_model(path("")), InputError);
  write_model(path("a"), some_model());
  std::string bytes = bytes_of(path("a"));
  bytes[8] = 2;
  write_bytes(path("b"), bytes);
  EXPECT_THROW(read_model(path("b")), InputError);
  bytes[0] = 'X';
  write_bytes(path("b"), bytes);
  EXPECT_THROW(read_model(path("b")), InputError);
}

TEST_F(ModelFile, IsNotWrittenWhenInvalid) {
  Model model = some_model();
  model.vocabulary.words.at<float>(3, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_model(path("a"), model), InputError);
  model = some_model();
  model.tree.nodes[4].parent = 4;
  EXPECT_THROW(write_model(path("a"), model), InputError);
  model = some_model();
  model.tree.nodes.pop_back();
  EXPECT_THROW(write_model(path("a"), model), InputError);
  model = some_model();
  model.background.push_back({{30}});
  EXPECT_THROW(write_model(path("a"), model), InputError);
  EXPECT_FALSE(fs::exists(path("a")));
}

TEST(Model, RequiresItsOwnFeatures) {
  const Model model = some_model();
  EXPECT_NO_THROW(require_features(model, model.features));
  FeatureOptions features = model.features;
  features.kind = {DetectorKind::Orb, DescriptorKind::Orb};
  EXPECT_THROW(require_features(model, features), InputError);
  features = model.features;
  features.clahe_clip_limit = 4.0;
  EXPECT_THROW(require_features(model, features), InputError);
}

/// Images of 12 places, three of each, whose descriptors are the place's own with noise.
Features features_of_image(std::size_t image) {
  Features features;
  const cv::Mat place = testing_support::clustered_descriptors(40, 16, 40, 100 + image / 3);
  cv::Mat noise(place.size(), CV_32F);
  cv::RNG(image).fill(noise, cv::RNG::NORMAL, 0.0, 0.1);
  features.descriptors = place + noise;
  return features;
}

TEST(ModelTraining, RecognisesThePlacesItWasTrainedOn) {
  ModelTrainingOptions options;
  options.num_words = 200;
  const TrainedModel trained = train_model(36, features_of_image, options);
  EXPECT_EQ(trained.report.num_images, 36u);
  EXPECT_EQ(trained.report.num_descriptors, 36u * 40u);
  EXPECT_EQ(trained.report.num_words, trained.model.vocabulary.num_words());
  EXPECT_GT(trained.report.mean_words_per_image, 10.0);
  EXPECT_GT(trained.report.mutual_information, 0.0);
  PlaceRecognizer recognizer(trained.model);
  const auto observe_image = [&](std::size_t image) {
    return observe(trained.model.vocabulary, features_of_image(image).descriptors);
  };
  for (std::size_t place = 0; place < 12; ++place) recognizer.add_place(observe_image(3 * place));
  for (std::size_t place = 0; place < 12; ++place) {
    EXPECT_GT(recognizer.recognize(observe_image(3 * place + 1)).p_place[place], 0.99);
  }
}

TEST(ModelTraining, DoesNotDependOnThreadsOrOnWhatIsKept) {
  ModelTrainingOptions options;
  options.num_threads = 1;
  options.max_descriptors = 700;
  const Model model = train_model(36, features_of_image, options).model;
  EXPECT_LE(model.provenance.num_descriptors, 720u);
  options.num_threads = 3;
  options.max_kept_bytes = 20000;
  const Model again = train_model(36, features_of_image, options).model;
  EXPECT_EQ(cv::norm(model.vocabulary.words, again.vocabulary.words, cv::NORM_INF), 0.0);
  for (WordId word = 0; word < model.tree.num_words(); ++word) {
    EXPECT_EQ(model.tree.nodes[word].parent, again.tree.nodes[word].parent);
    EXPECT_EQ(model.tree.nodes[word].p_if_parent, again.tree.nodes[word].p_if_parent);
  }
  for (std::size_t i = 0; i < model.background.size(); ++i) EXPECT_EQ(model.background[i].words, again.background[i].words);
}

TEST(ModelTraining, TakesImagesWithoutFeatures) {
  const auto features = [](std::size_t image) { return image % 2 == 0 ? Features{} : features_of_image(image); };
  const TrainedModel trained = train_model(6, features);
  EXPECT_EQ(trained.report.num_images_without_words, 3u);
  EXPECT_NO_THROW(validate(trained.model, "model"));
  EXPECT_THROW(train_model(3, [](std::size_t) { return Features{}; }), InputError);
  EXPECT_THROW(train_model(0, features), InputError);
}

TEST_F(ModelFile, KeepsItsHash) {
  const Model model = some_model();
  write_model(path("m"), model);
  EXPECT_EQ(model_hash(read_model(path("m"))), model_hash(model));
}

TEST(ModelHash, ChangesWithAllThatWordsMeanAndNothingElse) {
  const Model model = some_model();
  const std::string hash = model_hash(model);
  EXPECT_EQ(hash.size(), 16U);
  Model other = model;
  other.provenance.command = "another";
  other.background.clear();
  EXPECT_EQ(model_hash(other), hash);
  const std::vector<std::function<void(Model&)>> changes = {
      [](Model& m) { m.features.detection_threshold = 0.003; },
      [](Model& m) { m.detector.p_seen_if_absent = 0.02; },
      [](Model& m) { m.tree.nodes.back().p_if_parent += 1e-9; },
      [](Model& m) { (m.vocabulary.words = m.vocabulary.words.clone()).at<float>(29, 6) += 1e-4F; },
  };
  for (const auto& change : changes) {
    other = model;
    change(other);
    EXPECT_NE(model_hash(other), hash);
  }
}

}  // namespace
}  // namespace fabloop
