// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/vocabulary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frontend/error.h"
#include "frontend/fabmap/cluster_means.h"
#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "tests/support/descriptor_sampling.h"

namespace fabloop {
namespace {

using testing_support::clustered_descriptors;

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat random_descriptor_bits(int count, int bytes, std::uint64_t seed) {
  cv::Mat descriptors(count, bytes, CV_8U);
  cv::RNG(seed).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  return descriptors;
}

TEST(Vocabulary, FindsTheNearestWord) {
  const cv::Mat words = clustered_descriptors(300, 32, 300, 1);
  const cv::Mat points = clustered_descriptors(2500, 32, 700, 2);
  const NearestRows nearest = nearest_rows(words, points, 1);
  constexpr double kFloatRounding = 1e-3;  // Of squared distances around 500 in single precision.
  for (int i = 0; i < points.rows; i += 7) {
    double best = std::numeric_limits<double>::max();
    for (int word = 0; word < words.rows; ++word) best = std::min(best, cv::norm(points.row(i), words.row(word), cv::NORM_L2SQR));
    const auto row = static_cast<int>(nearest.row[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(cv::norm(points.row(i), words.row(row), cv::NORM_L2SQR), best, kFloatRounding);
  }
  const NearestRows in_parallel = nearest_rows(words, points, 4);
  EXPECT_EQ(nearest.row, in_parallel.row);
  EXPECT_EQ(nearest.squared_distance, in_parallel.squared_distance);
}

TEST(Vocabulary, MeasuresBitsByHammingDistance) {
  const cv::Mat bits = random_descriptor_bits(50, 32, 3);
  const cv::Mat numbers = float_descriptors(bits);
  ASSERT_EQ(numbers.cols, 256);
  for (int i = 1; i < bits.rows; ++i) {
    EXPECT_EQ(cv::norm(numbers.row(0), numbers.row(i), cv::NORM_L2SQR), cv::norm(bits.row(0), bits.row(i), cv::NORM_HAMMING));
  }
  EXPECT_EQ(nearest_words({numbers}, bits)[17], 17u);
}

TEST(Vocabulary, ObservesEachWordOnce) {
  const Vocabulary vocabulary{(cv::Mat_<float>(3, 2) << 0, 0, 10, 0, 0, 10)};
  const cv::Mat descriptors = (cv::Mat_<float>(4, 2) << 1, 9, 0, 1, 1, 1, 0, 11);
  EXPECT_EQ(nearest_words(vocabulary, descriptors), (std::vector<WordId>{2, 0, 0, 2}));
  EXPECT_EQ(observe(vocabulary, descriptors).words, (std::vector<WordId>{0, 2}));
  EXPECT_TRUE(observe(vocabulary, cv::Mat()).words.empty());
  EXPECT_EQ(observe({vocabulary.words.rowRange(0, 1)}, descriptors).words, (std::vector<WordId>{0}));
}

TEST(Vocabulary, RefusesDescriptorsThatItCannotRead) {
  const Vocabulary vocabulary{cv::Mat::zeros(3, 4, CV_32F)};
  cv::Mat bad = cv::Mat::zeros(2, 4, CV_32F);
  bad.at<float>(1, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(observe(vocabulary, bad), InputError);
  bad.at<float>(1, 2) = std::numeric_limits<float>::infinity();
  EXPECT_THROW(observe(vocabulary, bad), InputError);
  EXPECT_THROW(observe(vocabulary, cv::Mat::zeros(2, 5, CV_32F)), InputError);
  EXPECT_THROW(observe(vocabulary, cv::Mat::zeros(2, 4, CV_64F)), InputError);
  EXPECT_THROW(validate(Vocabulary{}, "here"), InputError);
  EXPECT_THROW(validate(Vocabulary{bad}, "here"), InputError);
}

TEST(KMeans, FindsSeparatedClusters) {
  const cv::Mat descriptors = clustered_descriptors(600, 16, 12, 4);
  KMeansOptions options;
  options.num_words = 60;  // So many that the random start has some in every cluster.
  const Vocabulary vocabulary = train_k_means(descriptors, options);
  ASSERT_EQ(vocabulary.num_words(), 60u);
  const NearestRows nearest = nearest_rows(vocabulary.words, descriptors, 1);
  // Each centre is where its cluster is: 16 dimensions of standard deviation 0.2 are 0.64 in squared distance.
  for (const float squared_distance : nearest.squared_distance) EXPECT_LT(squared_distance, 3.0f);
}

TEST(KMeans, EndsAtMeansOfItsDescriptors) {
  const cv::Mat descriptors = clustered_descriptors(500, 8, 500, 5);
  KMeansOptions options;
  options.num_words = 20;
  options.max_iterations = 200;
  options.min_improvement = 0.0;
  const Vocabulary vocabulary = train_k_means(descriptors, options);
  cv::Mat moved = vocabulary.words.clone();
  move_to_means(moved, descriptors, nearest_rows(vocabulary.words, descriptors, 1).row, 1);
  EXPECT_LT(cv::norm(moved, vocabulary.words, cv::NORM_INF), 1e-5);
}

TEST(KMeans, DoesNotDependOnThreadsAndRepeats) {
  const cv::Mat descriptors = clustered_descriptors(5000, 32, 700, 6);
  KMeansOptions options;
  options.num_words = 100;
  options.num_threads = 1;
  const Vocabulary once = train_k_means(descriptors, options);
  options.num_threads = 3;
  EXPECT_TRUE(same_bytes(once.words, train_k_means(descriptors, options).words));
  options.seed = 2;
  EXPECT_FALSE(same_bytes(once.words, train_k_means(descriptors, options).words));
}

TEST(KMeans, IsAsGoodWithManyDescriptors) {
  // So many that descriptors are compared with nearby words only: the end may be no worse than where each is compared with all.
  constexpr int kNumWords = 1000, kNumDescriptors = 20000;
  cv::Mat directions(6, 20, CV_32F), along(kNumDescriptors, 6, CV_32F);
  cv::RNG(13).fill(directions, cv::RNG::NORMAL, 0.0, 1.0);
  cv::RNG(14).fill(along, cv::RNG::NORMAL, 0.0, 1.0);
  const cv::Mat descriptors = along * directions;
  KMeansOptions options;
  options.num_words = kNumWords;
  options.max_iterations = 4;
  const Vocabulary vocabulary = train_k_means(descriptors, options);
  cv::Mat centres;
  for (const std::size_t row : sample_without_replacement(kNumDescriptors, kNumWords, options.seed)) {
    centres.push_back(descriptors.row(static_cast<int>(row)));
  }
  for (int iteration = 0; iteration < 5; ++iteration) {
    move_to_means(centres, descriptors, nearest_rows(centres, descriptors, 1).row, 1);
  }
  const auto inertia = [&](const cv::Mat& words) {
    double sum = 0.0;
    for (const float distance : nearest_rows(words, descriptors, 1).squared_distance) sum += static_cast<double>(distance);
    return sum;
  };
  constexpr double kMaxWorse = 1.005;  // A point in a hundred may have missed its nearest word until the end.
  EXPECT_LT(inertia(vocabulary.words), kMaxWorse * inertia(centres));
}

TEST(KMeans, GivesNoEmptyWords) {
  cv::Mat descriptors = clustered_descriptors(3, 4, 3, 7);
  for (int i = 0; i < 6; ++i) descriptors.push_back(descriptors.row(i % 3).clone());
  KMeansOptions options;
  options.num_words = 8;
  EXPECT_EQ(train_k_means(descriptors, options).num_words(), 3u);
  options.num_words = 100;
  EXPECT_EQ(train_k_means(clustered_descriptors(5, 4, 5, 8), options).num_words(), 5u);
  options.num_words = 1;
  EXPECT_EQ(train_k_means(descriptors, options).num_words(), 1u);
  EXPECT_THROW(train_k_means(cv::Mat(), options), InputError);
}

TEST(RadiusClustering, ChoosesCentresFurtherApartThanTheRadiusThatCoverAll) {
  const cv::Mat descriptors = clustered_descriptors(6000, 8, 6000, 9);
  RadiusClusteringOptions options;
  options.radius = 6.0;
  const cv::Mat centres = radius_centres(descriptors, options);
  ASSERT_GT(centres.rows, 20);
  constexpr double kFloatRounding = 1e-3;
  for (int i = 0; i < centres.rows; ++i) {
    for (int j = 0; j < i; ++j) EXPECT_GT(cv::norm(centres.row(i), centres.row(j)), options.radius - kFloatRounding);
  }
  for (const float squared_distance : nearest_rows(centres, descriptors, 1).squared_distance) {
    EXPECT_LE(std::sqrt(squared_distance), options.radius + kFloatRounding);
  }
}

TEST(RadiusClustering, FindsSeparatedClusters) {
  RadiusClusteringOptions options;
  options.radius = 4.0;
  const Vocabulary vocabulary = train_radius_clustering(clustered_descriptors(600, 16, 12, 4), options);
  EXPECT_EQ(vocabulary.num_words(), 12u);
}

TEST(RadiusClustering, DoesNotDependOnThreads) {
  const cv::Mat descriptors = clustered_descriptors(6000, 16, 6000, 10);
  RadiusClusteringOptions options;
  options.radius = 9.0;
  options.num_threads = 1;
  const Vocabulary once = train_radius_clustering(descriptors, options);
  options.num_threads = 3;
  EXPECT_TRUE(same_bytes(once.words, train_radius_clustering(descriptors, options).words));
}

TEST(RadiusClustering, DoesNotDependOnTheOrderOfDescriptors) {
  const cv::Mat descriptors = clustered_descriptors(3000, 16, 3000, 12);
  cv::Mat reversed;
  cv::flip(descriptors, reversed, 0);
  RadiusClusteringOptions options;
  options.radius = 9.0;
  const Vocabulary once = train_radius_clustering(descriptors, options);
  EXPECT_TRUE(same_bytes(once.words, train_radius_clustering(reversed, options).words));
  options.seed = 2;
  EXPECT_FALSE(same_bytes(once.words, train_radius_clustering(descriptors, options).words));
}

TEST(RadiusClustering, RefusesRadiiThatMakeNoSense) {
  const cv::Mat descriptors = clustered_descriptors(100, 16, 100, 11);
  RadiusClusteringOptions options;
  EXPECT_THROW(radius_centres(descriptors, options), InputError);
  options.radius = 1e-3;
  options.max_words = 50;
  EXPECT_THROW(radius_centres(descriptors, options), InputError);
  EXPECT_THROW(train_radius_clustering(cv::Mat(), options), InputError);
}

}  // namespace
}  // namespace fabloop
