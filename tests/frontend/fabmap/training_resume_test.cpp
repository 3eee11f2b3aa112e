// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>

#include "frontend/fabmap/model_training.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/support/descriptor_sampling.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kNumImages = 70;  // three blocks

/// Images of 12 places, in turn, whose descriptors are the place's own with noise.
Features features_of_small_image(std::size_t image) {
  Features features;
  const cv::Mat place = fabloop::testing_support::clustered_descriptors(25, 8, 25, 100 + image % 12);
  cv::Mat noise(place.size(), CV_32F);
  cv::RNG(image).fill(noise, cv::RNG::NORMAL, 0.0, 0.5);
  features.descriptors = place + noise;
  return features;
}

/// What a kill is to the library: something that is no InputError stops it where it is.
struct Killed {};

class TrainingResume : public ::testing::Test {
 protected:
  TrainingResume() {
    options_.num_words = 60;
    options_.max_descriptors = 1000;
    options_.state_folder = folder_.path() / "model.part";
    options_.warn = [this](const std::string& message) { warnings_.push_back(message); };
    options_.num_threads = 1;
    uninterrupted_ = bytes_of_training(without_state());
  }

  ModelTrainingOptions without_state() const {
    ModelTrainingOptions options = options_;
    options.state_folder.clear();
    return options;
  }

  std::string bytes_of_training(const ModelTrainingOptions& options) {
    const fs::path path = folder_.path() / "written.model";
    write_model(path, train_model(
                          kNumImages,
                          [this](std::size_t image) {
                            ++num_described_;
                            return features_of_small_image(image);
                          },
                          options)
                          .model);
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  /// Trains until the progress of a stage has been told `reports` times, and is killed there. False when it came to its end.
  bool train_and_kill(const std::string& stage, int reports) {
    ModelTrainingOptions options = options_;
    options.progress = [&, left = reports](std::string_view now, std::size_t, std::size_t) mutable {
      if (now == stage && --left == 0) throw Killed();
    };
    try {
      bytes_of_training(options);
    } catch (const Killed&) {
      return true;
    }
    return false;
  }

  void spoil(const fs::path& file) const {
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(-3, std::ios::end);
    stream.put('\x55');
  }

  TemporaryFolder folder_;
  ModelTrainingOptions options_;
  std::vector<std::string> warnings_;
  std::string uninterrupted_;
  int num_described_ = 0;
};

TEST_F(TrainingResume, GivesTheSameModelWhereverItWasKilled) {
  for (const auto& [stage, reports, resumed_at] : {std::tuple{"describing images", 1, "resuming at describing images of "},
                                                   {"describing images", 3, "resuming at describing images of "},
                                                   {"k-means", 1, "resuming at describing images of "},
                                                   {"k-means", 3, "resuming at k-means, iteration 3, of "},
                                                   {"finding words", 1, "resuming at finding words of "},
                                                   {"finding words", 3, "resuming at finding words of "},
                                                   {"linking words", 10, "resuming at finding words of "}}) {
    ASSERT_TRUE(train_and_kill(stage, reports)) << stage;
    warnings_.clear();
    EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_) << stage << ' ' << reports;
    ASSERT_EQ(warnings_.size(), 1u) << stage << ' ' << reports;
    EXPECT_EQ(warnings_[0], resumed_at + options_.state_folder.string());
    fs::remove_all(options_.state_folder);
  }
}

TEST_F(TrainingResume, GivesTheSameModelWhenKilledAgainAndAgain) {
  while (train_and_kill("k-means", 3)) {
  }
  EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_);
}

TEST_F(TrainingResume, DescribesNoImageTwice) {
  ASSERT_TRUE(train_and_kill("describing images", 2));
  num_described_ = 0;
  bytes_of_training(options_);
  EXPECT_EQ(num_described_, static_cast<int>(kNumImages) - 64);
}

TEST_F(TrainingResume, DescribesAgainWhatTheDiskHasNoRoomFor) {
  options_.max_state_bytes = 30000;  // one block of three
  num_described_ = 0;
  EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_);
  EXPECT_EQ(num_described_, static_cast<int>(kNumImages) * 2 - 32);
}

TEST_F(TrainingResume, NoticesDamagedFiles) {
  ASSERT_TRUE(train_and_kill("finding words", 2));
  for (const std::string name : {"sample-00000", "vocabulary", "k-means", "words-00001", "descriptors-00002"}) {
    spoil(options_.state_folder / name);
  }
  warnings_.clear();
  EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_);
  for (const std::string name : {"sample-00000", "vocabulary", "k-means", "words-00001", "descriptors-00002"}) {
    EXPECT_THAT(warnings_, ::testing::Contains(HasSubstr(name + " is damaged"))) << name;
  }
}

TEST_F(TrainingResume, NoticesTruncatedAndEmptyFiles) {
  ASSERT_TRUE(train_and_kill("finding words", 2));
  fs::resize_file(options_.state_folder / "vocabulary", 100);
  fs::resize_file(options_.state_folder / "words-00000", 0);
  EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_);
}

TEST_F(TrainingResume, StartsAnewOnOtherOptionsOrImagesAndSaysSo) {
  ASSERT_TRUE(train_and_kill("finding words", 2));
  options_.seed = 7;
  warnings_.clear();
  EXPECT_TRUE(bytes_of_training(options_) == bytes_of_training(without_state()));
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], HasSubstr("with other options (now: seed 7); starting anew"));
  options_.images_identity = "0001.jpg 12345 678\n";
  warnings_.clear();
  bytes_of_training(options_);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], HasSubstr("now: 0001.jpg 12345 678"));
}

TEST_F(TrainingResume, DiscardsTheStateWhenAsked) {
  ASSERT_TRUE(train_and_kill("finding words", 2));
  options_.if_state_found = WorkState::IfFound::Discard;
  warnings_.clear();
  num_described_ = 0;
  EXPECT_TRUE(bytes_of_training(options_) == uninterrupted_);
  EXPECT_THAT(warnings_, IsEmpty());
  EXPECT_EQ(num_described_, static_cast<int>(kNumImages));
}

TEST_F(TrainingResume, RefusesAFolderThatIsSomethingElse) {
  folder_.write("model.part/holiday.txt", std::string("photos"));
  EXPECT_THAT(input_error_of([&] { bytes_of_training(options_); }), HasSubstr("model.part: is needed for the training's state"));
  EXPECT_TRUE(fs::exists(options_.state_folder / "holiday.txt"));
}

TEST_F(TrainingResume, LeavesNoStateOfBadInput) {
  const auto bad = [](std::size_t image) {
    return image == 40 ? throw InputError("0040.jpg: is damaged") : features_of_small_image(image);
  };
  EXPECT_THROW(train_model(kNumImages, bad, options_), InputError);
  EXPECT_FALSE(fs::exists(options_.state_folder));
}

}  // namespace
}  // namespace fabloop
