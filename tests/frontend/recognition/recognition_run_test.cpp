// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frontend/recognition/matrix_picture.h"
#include "frontend/recognition/row_spool.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/frontend/word_model.h"

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing_support::model_of_words;

/// An image at each of the places, which show six words of their own.
std::vector<ObservedImage> images_at(const std::vector<WordId>& places) {
  std::vector<ObservedImage> images;
  for (const WordId place : places) {
    ObservedImage image{2 * images.size(), static_cast<std::int64_t>(images.size()), {}};
    for (WordId word = 0; word < 6; ++word) image.observation.words.push_back(6 * place + word);
    images.push_back(image);
  }
  return images;
}

RecognitionOptions options_without_window() {
  RecognitionOptions options;
  options.num_recent_excluded = 0;
  return options;
}

TEST(RecognitionRun, WarnsOfImagesUnlikeTheTraining) {
  Model model = model_of_words();
  // No image of the training was less likely than one nat a word.
  model.domain = Domain{std::vector<double>(101, 0.0), std::vector<double>(101, -1.0)};
  std::size_t num_warnings = 0;
  RecognitionOptions options = options_without_window();
  options.warn = [&](const std::string&) { ++num_warnings; };
  recognize_sequence(model, images_at(std::vector<WordId>(15, 1)), options);
  EXPECT_EQ(num_warnings, 0u) << "too few images to tell";
  recognize_sequence(model, images_at(std::vector<WordId>(40, 1)), options);
  EXPECT_EQ(num_warnings, 1u);
}

TEST(RecognitionRun, EachImageIsRecognisedAmongThoseBeforeIt) {
  std::vector<std::size_t> row_lengths;
  RecognitionOptions options = options_without_window();
  options.on_row = [&](std::span<const double> p_place, std::span<const double> log_likelihood) {
    EXPECT_EQ(p_place.size(), log_likelihood.size());
    row_lengths.push_back(p_place.size());
  };
  const Recognition run = recognize_sequence(model_of_words(), images_at({0, 1, 2, 3, 1}), options);
  EXPECT_THAT(row_lengths, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(run.places, (PlaceFrames{{0}, {2}, {4}, {6}, {8}}));
  EXPECT_EQ(run.images[0].p_new, 1.0);
  EXPECT_GT(run.images[3].p_new, 0.9);
  ASSERT_FALSE(run.images[4].matches.empty());
  EXPECT_EQ(run.images[4].matches[0].place, 1u);
  EXPECT_GT(run.images[4].matches[0].probability, 0.9);
  EXPECT_EQ(run.images[4].frame, 8u);
}

TEST(RecognitionRun, RevisitsJoinTheirPlace) {
  RecognitionOptions options = options_without_window();
  options.slam.revisit = Revisit::AboveThreshold;
  const Recognition run = recognize_sequence(model_of_words(), images_at({0, 1, 2, 1, 0}), options);
  EXPECT_EQ(run.places, (PlaceFrames{{0, 8}, {2, 6}, {4}}));
  EXPECT_FALSE(run.images[3].is_new);
  EXPECT_EQ(run.images[3].place, 1u);
  EXPECT_EQ(run.place_times_ns, (std::vector<std::int64_t>{0, 1, 2}));
}

TEST(RecognitionRun, RecentPlacesAreLeftOutOfTheNormalisationToo) {
  RecognitionOptions options;
  options.num_recent_excluded = 2;
  std::vector<double> sums;
  options.on_row = [&](std::span<const double> p_place, std::span<const double>) {
    double sum = 0.0;
    for (const double p : p_place) sum += p;
    sums.push_back(sum);
  };
  const Recognition run = recognize_sequence(model_of_words(), images_at({0, 1, 2, 2, 0}), options);
  constexpr double kPosteriorTolerance = 1e-12;
  for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_NEAR(sums[i] + run.images[i].p_new, 1.0, kPosteriorTolerance);
  EXPECT_GT(run.images[3].p_new, 0.9) << "the place just left does not count";
  EXPECT_EQ(run.images[4].matches[0].place, 0u);
  EXPECT_EQ(run.images[4].matches.size(), 2u);
}

TEST(RecognitionRun, AMapStaysAsItIs) {
  const Recognition run =
      recognize_in_map(model_of_words(), images_at({0, 1, 2}), images_at({2, 5, 0}), options_without_window());
  EXPECT_EQ(run.places, (PlaceFrames{{0}, {2}, {4}}));
  EXPECT_EQ(run.images.size(), 3u);
  EXPECT_EQ(run.images[0].matches[0].place, 2u);
  EXPECT_FALSE(run.images[0].is_new);
  EXPECT_TRUE(run.images[1].is_new);
  EXPECT_EQ(run.images[2].matches[0].place, 0u);
}

TEST(RecognitionRun, WithoutANewPlaceTheBeliefIsOverTheMapAlone) {
  RecognitionOptions options = options_without_window();
  options.slam.recognizer.new_place = NewPlaceModel::None;
  const Recognition run = recognize_in_map(model_of_words(), images_at({0, 1}), images_at({5}), options);
  EXPECT_EQ(run.images[0].p_new, 0.0);
  constexpr double kPosteriorTolerance = 1e-12;
  EXPECT_NEAR(run.images[0].matches[0].probability + run.images[0].matches[1].probability, 1.0, kPosteriorTolerance);
  EXPECT_NEAR(run.images[0].matches[0].log_odds, 0.0, 1e-9) << "neither is like it";
}

TEST(RecognitionRun, LogOddsAreThoseOfTheProbability) {
  const Recognition run = recognize_sequence(model_of_words(), images_at({0, 1, 2, 3, 1, 2}), options_without_window());
  for (const RecognizedImage& image : run.images) {
    for (const PlaceMatch& match : image.matches) {
      constexpr double kRelative = 1e-6;
      const double expected = std::log(match.probability / (1.0 - match.probability));
      EXPECT_NEAR(match.log_odds, expected, kRelative * std::abs(expected));
    }
  }
}

TEST(RowSpool, GivesBackRowsOfAnyLength) {
  const TemporaryFolder folder;
  const std::vector<std::vector<double>> rows = {{}, {1, 2, 3}, {4}};
  {
    RowSpool spool(folder.path() / "rows");
    for (const auto& row : rows) spool.add_row(row);
    EXPECT_EQ(spool.max_length(), 3u);
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<std::vector<double>> read;
      spool.for_each_row([&](std::size_t index, std::span<const double> row) {
        EXPECT_EQ(index, read.size());
        read.emplace_back(row.begin(), row.end());
      });
      EXPECT_EQ(read, rows);
    }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THROW(RowSpool(folder.path() / "absent" / "rows"), InputError);
}

TEST(MatrixThumbnail, KeepsThePeaks) {
  MatrixThumbnail thumbnail(4, 5, 3);
  EXPECT_EQ(thumbnail.entries_a_cell(), 2u);
  thumbnail.add_row(0, std::vector<double>{1, 2, 3});
  thumbnail.add_row(1, std::vector<double>{5, std::nan(""), -1, -9});
  thumbnail.add_row(3, std::vector<double>{0});
  const cv::Mat& cells = thumbnail.cells();
  ASSERT_EQ(cells.size(), cv::Size(3, 2));
  EXPECT_EQ(cells.at<double>(0, 0), 5.0);
  EXPECT_EQ(cells.at<double>(0, 1), 3.0);
  EXPECT_TRUE(std::isnan(cells.at<double>(0, 2)));
  EXPECT_EQ(cells.at<double>(1, 0), 0.0);
  EXPECT_TRUE(std::isnan(cells.at<double>(1, 1)));
}

TEST(MatrixPicture, StaysBelow2000PixelsForAnyShape) {
  for (const auto& [rows, columns] : {std::pair<std::size_t, std::size_t>{1, 1}, {3, 2000}, {5000, 7}, {801, 799}, {0, 0}}) {
    MatrixThumbnail values(rows, columns), truth(rows, columns);
    const cv::Mat picture = draw_matrix({"any", values, probability_scale(), &truth});
    EXPECT_LT(picture.cols, 2000) << rows << " x " << columns;
    EXPECT_LT(picture.rows, 2000) << rows << " x " << columns;
    EXPECT_GT(picture.cols, 200);
    likelihood_scale(values);
  }
}

TEST(MatrixPicture, LikelihoodsAreShownAboveTheirMedian) {
  const double nothing = std::nan("");
  const auto row = above_median(std::vector<double>{-5, -3, nothing, -1});
  EXPECT_EQ(row[1], 0.0);
  EXPECT_EQ(row[3], 2.0);
  EXPECT_TRUE(std::isnan(row[2]));
  EXPECT_TRUE(above_median({}).empty());
}

}  // namespace
}  // namespace fabloop
