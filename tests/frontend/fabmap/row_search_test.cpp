// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/row_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/features/dot_products.h"
#include "tests/support/descriptor_sampling.h"

namespace fabloop {
namespace {

/// Rows that vary in a few directions most, as real descriptors do.
cv::Mat rows_with_structure(int count, int dimensions, std::uint64_t seed) {
  constexpr int kDirections = 9;
  cv::RNG generator(seed);
  cv::Mat directions(kDirections, dimensions, CV_32F), along(count, kDirections, CV_32F), noise(count, dimensions, CV_32F);
  cv::RNG(77).fill(directions, cv::RNG::NORMAL, 0.0, 1.0);
  generator.fill(along, cv::RNG::NORMAL, 0.0, 1.0);
  generator.fill(noise, cv::RNG::NORMAL, 0.0, 0.4);
  return cv::Mat(along * directions + noise + 3.0);
}

cv::Mat uniform_rows(int count, int dimensions, std::uint64_t seed) {
  cv::Mat rows(count, dimensions, CV_32F);
  cv::RNG(seed).fill(rows, cv::RNG::UNIFORM, 0.0, 1.0);
  return rows;
}

/// The definition: all differences, ties to the lower row.
NearestRows by_definition(const cv::Mat& rows, const cv::Mat& points) {
  NearestRows nearest;
  for (int i = 0; i < points.rows; ++i) {
    float best = std::numeric_limits<float>::infinity();
    std::uint32_t best_row = 0;
    for (int row = 0; row < rows.rows; ++row) {
      const float distance = squared_distance(points.ptr<float>(i), rows.ptr<float>(row), static_cast<std::size_t>(rows.cols));
      if (distance < best) {
        best = distance;
        best_row = static_cast<std::uint32_t>(row);
      }
    }
    nearest.row.push_back(best_row);
    nearest.squared_distance.push_back(best);
  }
  return nearest;
}

void expect_exact(const cv::Mat& rows, const cv::Mat& points) {
  const NearestRows expected = by_definition(rows, points);
  for (const RowSearchKind kind : {RowSearchKind::Once, RowSearchKind::ManyTimes}) {
    const RowSearch search(rows, kind);
    const std::vector<std::uint32_t> bad_guesses(expected.row.size(), static_cast<std::uint32_t>(rows.rows - 1));
    for (const NearestRows& nearest : {search.nearest(points, 1), search.nearest(points, 3),
                                       search.nearest(points, 1, expected.row), search.nearest(points, 1, bad_guesses)}) {
      EXPECT_EQ(nearest.row, expected.row);
      EXPECT_EQ(nearest.squared_distance, expected.squared_distance);
    }
  }
}

TEST(RowSearch, IsExactWithAndWithoutStructure) {
  for (const int dimensions : {1, 7, 32, 61, 128}) {
    expect_exact(rows_with_structure(700, dimensions, 1), rows_with_structure(150, dimensions, 2));
    expect_exact(uniform_rows(300, dimensions, 3), uniform_rows(61, dimensions, 4));
  }
  for (const int count : {1, 2, 15, 16, 17, 255, 256, 257}) {
    expect_exact(rows_with_structure(count, 40, 5), rows_with_structure(33, 40, 6));
  }
}

TEST(RowSearch, GivesTheLowerOfEqualRows) {
  cv::Mat rows = rows_with_structure(300, 64, 7);
  rows.push_back(rows.clone());
  rows.push_back(rows.rowRange(0, 50).clone());
  expect_exact(rows, rows_with_structure(100, 64, 8));
  expect_exact(rows, rows);
  expect_exact(cv::Mat::zeros(400, 64, CV_32F), uniform_rows(20, 64, 9));
}

TEST(RowSearch, IsExactFarFromTheRows) {
  const cv::Mat rows = rows_with_structure(600, 64, 10);
  expect_exact(rows, cv::Mat(rows_with_structure(50, 64, 11) * 1e4));
  expect_exact(rows, cv::Mat(rows_with_structure(50, 64, 12) * 1e-6));
  expect_exact(cv::Mat(rows + 1e4), cv::Mat(rows_with_structure(50, 64, 13) + 1e4));
  expect_exact(rows, cv::Mat::zeros(3, 64, CV_32F));
}

TEST(RowSearch, FindsNearlyAllByCells) {
  const cv::Mat rows = rows_with_structure(3000, 64, 14), points = rows_with_structure(1500, 64, 15);
  const RowSearch search(rows, RowSearchKind::ManyTimes);
  const NearestRows near = search.near(points, 1), nearest = search.nearest(points, 1);
  std::size_t num_same = 0;
  for (std::size_t i = 0; i < near.row.size(); ++i) {
    num_same += near.row[i] == nearest.row[i] ? 1 : 0;
    EXPECT_GE(near.squared_distance[i], nearest.squared_distance[i]);
  }
  EXPECT_GT(num_same, 1350u);
  EXPECT_EQ(near.row, search.near(points, 3).row);
  const NearestRows alone = search.near(points.rowRange(700, 701), 1);
  EXPECT_EQ(alone.row[0], near.row[700]);
}

TEST(RowSearch, FindsNearlyAllSeconds) {
  const cv::Mat rows = rows_with_structure(3000, 64, 14), points = rows_with_structure(1000, 64, 15);
  const RowSearch search(rows, RowSearchKind::ManyTimes);
  const NearestRows two = search.near_two(points, 1), near = search.near(points, 1);
  EXPECT_TRUE(near.second_row.empty());
  int num_same = 0;
  for (int i = 0; i < points.rows; ++i) {
    const auto place = static_cast<std::size_t>(i);
    std::vector<float> distances;
    for (int row = 0; row < rows.rows; ++row) {
      distances.push_back(squared_distance(points.ptr<float>(i), rows.ptr<float>(row), static_cast<std::size_t>(rows.cols)));
    }
    EXPECT_EQ(two.squared_distance[place], distances[two.row[place]]);
    EXPECT_EQ(two.second_squared_distance[place], distances[two.second_row[place]]);
    EXPECT_LE(two.squared_distance[place], near.squared_distance[place]) << "to keep two must not lose the nearest";
    EXPECT_NE(two.row[place], two.second_row[place]);
    std::nth_element(distances.begin(), distances.begin() + 1, distances.end());
    num_same += two.second_squared_distance[place] == distances[1] ? 1 : 0;
  }
  EXPECT_GT(num_same, 900);
  EXPECT_EQ(two.second_row, search.near_two(points, 3).second_row);
}

TEST(RowSearch, OfFewRowsFindsBothExactly) {
  const cv::Mat rows = (cv::Mat_<float>(3, 1) << 0, 10, 11), points = (cv::Mat_<float>(2, 1) << 1, 12);
  const NearestRows two = RowSearch(rows, RowSearchKind::ManyTimes).near_two(points, 1);
  EXPECT_EQ(two.row, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(two.second_row, (std::vector<std::uint32_t>{1, 1}));
  const NearestRows one = RowSearch(rows.rowRange(0, 1), RowSearchKind::ManyTimes).near_two(points, 1);
  EXPECT_EQ(one.second_squared_distance[0], std::numeric_limits<float>::infinity());
}

TEST(WordFinder, FindsTheVocabularysWords) {
  const Vocabulary vocabulary{rows_with_structure(700, 64, 16)};
  const cv::Mat descriptors = rows_with_structure(90, 64, 17);
  const WordFinder finder(vocabulary);
  EXPECT_EQ(finder.nearest_words(descriptors), nearest_words(vocabulary, descriptors));
  EXPECT_EQ(finder.observe(descriptors).words, observe(vocabulary, descriptors).words);
  EXPECT_TRUE(finder.observe(cv::Mat()).words.empty());
  const WordFinder one_word({vocabulary.words.rowRange(0, 1)}, {WordSearch::Approximate});
  EXPECT_EQ(one_word.observe(descriptors).words, (std::vector<WordId>{0}));
  EXPECT_EQ(finder.observe(cv::Mat::zeros(5, 64, CV_32F)).words.size(), 1u);
}

TEST(WordFinder, MeasuresBitsByHammingDistance) {
  cv::Mat words(600, 32, CV_8U), bits(50, 32, CV_8U);
  cv::RNG(18).fill(words, cv::RNG::UNIFORM, 0, 256);
  cv::RNG(19).fill(bits, cv::RNG::UNIFORM, 0, 256);
  const std::vector<WordId> found = WordFinder({float_descriptors(words)}).nearest_words(bits);
  for (int i = 0; i < bits.rows; ++i) {
    double best = std::numeric_limits<double>::infinity();
    WordId best_word = 0;
    for (int word = 0; word < words.rows; ++word) {
      const double distance = cv::norm(bits.row(i), words.row(word), cv::NORM_HAMMING);
      if (distance < best) {
        best = distance;
        best_word = static_cast<WordId>(word);
      }
    }
    EXPECT_EQ(found[static_cast<std::size_t>(i)], best_word);
  }
}

TEST(WordFinder, RefusesWhatItCannotRead) {
  EXPECT_THROW(WordFinder{Vocabulary{}}, InputError);
  const WordFinder finder({rows_with_structure(300, 64, 20)});
  cv::Mat bad = rows_with_structure(3, 64, 21);
  EXPECT_THROW(finder.observe(bad.colRange(0, 63).clone()), InputError);
  bad.at<float>(2, 5) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(finder.observe(bad), InputError);
}

}  // namespace
}  // namespace fabloop
