// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/plot.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "frontend/drawing.h"

namespace fabloop {
namespace {

/// The pixels of a row that are not paper.
std::vector<bool> inked(const cv::Mat& picture, int row) {
  std::vector<bool> is_inked;
  for (int x = 0; x < picture.cols; ++x) is_inked.push_back(picture.at<cv::Vec3b>(row, x) != cv::Vec3b(255, 255, 255));
  return is_inked;
}

TEST(Plot, NoTwoLinesLookAlike) {
  using Look = std::pair<std::array<double, 3>, std::vector<double>>;
  std::set<Look> looks;
  for (std::size_t i = 0; i < plot::kNumStyles; ++i) {
    const plot::LineStyle style = plot::series_style(i);
    looks.insert({{style.colour[0], style.colour[1], style.colour[2]}, style.dashes_px});
  }
  EXPECT_EQ(looks.size(), plot::kNumStyles);
}

TEST(Plot, DashesGoOnThroughCornersAndPointsThatComeTwice) {
  // A straight line of many points has the dashes of one of two.
  cv::Mat straight(20, 200, CV_8UC3, plot::kPaper), in_steps = straight.clone();
  const std::vector<double> dashes = {12.0, 9.0};
  draw::dashed_polyline(straight, {{10, 10}, {190, 10}}, dashes, plot::kInk, 1);
  std::vector<cv::Point2d> path;
  for (double x = 10; x <= 190; x += 2.5) path.insert(path.end(), {{x, 10}, {x, 10}});
  draw::dashed_polyline(in_steps, path, dashes, plot::kInk, 1);
  const std::vector<bool> expected = inked(straight, 10);
  EXPECT_EQ(inked(in_steps, 10), expected);
  for (const int x : {10, 15, 20, 32, 40}) EXPECT_TRUE(expected[static_cast<std::size_t>(x)]) << x;
  for (const int x : {5, 24, 28, 45, 195}) EXPECT_FALSE(expected[static_cast<std::size_t>(x)]) << x;
}

TEST(Plot, ALineWithoutDashesIsWhole) {
  cv::Mat picture(20, 100, CV_8UC3, plot::kPaper);
  draw::dashed_polyline(picture, {{10, 10}, {90, 10}}, {}, plot::kInk, 1);
  for (int x = 10; x <= 90; ++x) EXPECT_NE(picture.at<cv::Vec3b>(10, x), cv::Vec3b(255, 255, 255)) << x;
}

}  // namespace
}  // namespace fabloop
