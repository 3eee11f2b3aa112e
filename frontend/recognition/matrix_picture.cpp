// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/matrix_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kMatrixSize = 800;  ///< Pixels of the longer side.
constexpr int kMatrixLeft = 85, kMatrixTop = 50, kMatrixBottom = 70, kGap = 90, kMatrixRight = 40;
constexpr int kBarGap = 20, kBarWidth = 18, kBarText = 80;

const cv::Vec3b kNoValue(214, 214, 214);
const cv::Vec3b kTrue(60, 150, 40);
const cv::Vec3b kNotJudged(150, 215, 245);
const cv::Vec3b kFalse(250, 250, 250);

/// 256 colours from dark to bright, CV_8UC3.
cv::Mat colour_table() {
  cv::Mat levels(256, 1, CV_8UC1);
  for (int i = 0; i < levels.rows; ++i) levels.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  cv::Mat colours;
  cv::applyColorMap(levels, colours, cv::COLORMAP_INFERNO);
  return colours;
}

cv::Mat coloured(const cv::Mat& cells, const ColourScale& scale) {
  const cv::Mat table = colour_table();
  cv::Mat result(cells.size(), CV_8UC3);
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      const double value = cells.at<double>(y, x);
      const double part = std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
      result.at<cv::Vec3b>(y, x) =
          std::isnan(value) ? kNoValue : table.at<cv::Vec3b>(static_cast<int>(std::lround(part * (table.rows - 1))));
    }
  }
  return result;
}

cv::Mat coloured_truth(const cv::Mat& cells) {
  cv::Mat result(cells.size(), CV_8UC3);
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      const double value = cells.at<double>(y, x);
      result.at<cv::Vec3b>(y, x) = std::isnan(value) ? kNoValue : value == 2.0 ? kTrue : value == 1.0 ? kNotJudged : kFalse;
    }
  }
  return result;
}

/// Puts the cells at a place and draws their axes.
void draw_panel(cv::Mat& canvas, const cv::Mat& colours, const cv::Rect& at, const MatrixThumbnail& matrix,
                const std::string& title) {
  cv::Mat large;
  cv::resize(colours, large, at.size(), 0, 0, cv::INTER_NEAREST);
  large.copyTo(canvas(at));
  const plot::Axis x{0.0, static_cast<double>(matrix.num_columns()), at.x, at.x + at.width, "place (column)"};
  const plot::Axis y{0.0, static_cast<double>(matrix.num_rows()), at.y, at.y + at.height, "query (row)"};
  plot::draw_axes(canvas, x, y);
  plot::write(canvas, title, {at.x, at.y - 18}, 0.0, plot::kTitleSize);
}

void draw_colour_bar(cv::Mat& canvas, const cv::Rect& at, const ColourScale& scale) {
  cv::Mat bar;
  cv::flip(colour_table(), bar, 0);
  cv::resize(bar, bar, at.size(), 0, 0, cv::INTER_LINEAR);
  bar.copyTo(canvas(at));
  cv::rectangle(canvas, at.tl() - cv::Point(1, 1), at.br(), plot::kInk);
  const plot::Axis axis{scale.low, scale.high, at.y + at.height, at.y, {}};
  for (const double value : plot::ticks(scale.low, scale.high)) {
    const int y = static_cast<int>(std::lround(axis.pixel(value)));
    cv::line(canvas, {at.br().x, y}, {at.br().x + 4, y}, plot::kInk);
    plot::write(canvas, plot::tick_text(value), {at.br().x + 8, y + 5});
  }
  plot::write_upwards(canvas, scale.label, {at.br().x + kBarText - 20, at.y + at.height / 2});
}

void draw_truth_legend(cv::Mat& canvas, const cv::Point& right_end) {
  int x = right_end.x;
  for (const auto& [colour, text] :
       {std::pair<cv::Vec3b, const char*>{kNotJudged, "not judged"}, {kFalse, "false"}, {kTrue, "true"}}) {
    x -= plot::text_width(text) + 34;
    cv::rectangle(canvas, {x, right_end.y - 11, 12, 12}, cv::Scalar(colour), cv::FILLED);
    cv::rectangle(canvas, {x, right_end.y - 11, 12, 12}, plot::kInk);
    plot::write(canvas, text, {x + 18, right_end.y});
  }
}

}  // namespace

MatrixThumbnail::MatrixThumbnail(std::size_t num_rows, std::size_t num_columns, std::size_t max_cells)
    : num_rows_(std::max<std::size_t>(1, num_rows)),
      num_columns_(std::max<std::size_t>(1, num_columns)),
      step_((std::max(num_rows_, num_columns_) + max_cells - 1) / max_cells),
      cells_(static_cast<int>((num_rows_ + step_ - 1) / step_), static_cast<int>((num_columns_ + step_ - 1) / step_), CV_64F,
             cv::Scalar(std::numeric_limits<double>::quiet_NaN())) {}

void MatrixThumbnail::add_row(std::size_t index, std::span<const double> row) {
  auto* cells = cells_.ptr<double>(static_cast<int>(index / step_));
  for (std::size_t column = 0; column < row.size(); ++column) {
    double& cell = cells[column / step_];
    if (!std::isnan(row[column]) && !(row[column] <= cell)) cell = row[column];
  }
}

cv::Mat draw_matrix(const MatrixPicture& picture) {
  const cv::Mat& cells = picture.values.cells();
  // Small matrices are enlarged by whole numbers, so that all entries look alike.
  const int enlarged = std::max(1, kMatrixSize / std::max(cells.rows, cells.cols));
  // A sliver of a matrix still needs room for its axes.
  constexpr int kLeastSize = 120;
  const cv::Size size(std::max(kLeastSize, cells.cols * enlarged), std::max(kLeastSize, cells.rows * enlarged));
  const int truth_width = picture.truth ? kGap + size.width : 0;
  cv::Mat canvas(kMatrixTop + size.height + kMatrixBottom,
                 kMatrixLeft + size.width + kBarGap + kBarWidth + kBarText + truth_width + kMatrixRight, CV_8UC3, plot::kPaper);
  const cv::Rect at({kMatrixLeft, kMatrixTop}, size);
  draw_panel(canvas, coloured(cells, picture.scale), at, picture.values, picture.title);
  draw_colour_bar(canvas, {at.br().x + kBarGap, at.y, kBarWidth, at.height}, picture.scale);
  if (picture.truth) {
    const cv::Rect truth_at({at.br().x + kBarGap + kBarWidth + kBarText + kGap, kMatrixTop}, size);
    draw_panel(canvas, coloured_truth(picture.truth->cells()), truth_at, *picture.truth, "truth");
    draw_truth_legend(canvas, {truth_at.br().x + 14, kMatrixTop - 18});
  }
  return canvas;
}

ColourScale probability_scale() { return {-6.0, 0.0, "log10 p(place | image)"}; }

ColourScale likelihood_scale(const MatrixThumbnail& values) {
  std::vector<double> finite;
  for (const double value : cv::Mat_<double>(values.cells())) {
    if (std::isfinite(value)) finite.push_back(value);
  }
  constexpr double kShare = 0.999;
  double high = 1.0;
  if (!finite.empty()) {
    const auto rank = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), finite.begin() + rank, finite.end());
    high = std::max(high, finite[static_cast<std::size_t>(rank)]);
  }
  return {0.0, high, "log p(image | place), above the row's median"};
}

std::vector<double> above_median(std::span<const double> row) {
  std::vector<double> finite;
  for (const double value : row) {
    if (std::isfinite(value)) finite.push_back(value);
  }
  if (finite.empty()) return std::vector<double>(row.size(), std::numeric_limits<double>::quiet_NaN());
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  std::vector<double> result(row.begin(), row.end());
  for (double& value : result) value -= *middle;
  return result;
}

MatrixThumbnail truth_thumbnail(const Recognition& recognition, const GroundTruth& truth) {
  MatrixThumbnail thumbnail(recognition.images.size(), recognition.places.size());
  std::vector<double> row;
  for (std::size_t i = 0; i < recognition.images.size(); ++i) {
    row.clear();
    for (PlaceId place = 0; place < recognition.images[i].num_places; ++place) {
      const MatchTruth is_true = judge_place(truth, recognition.images[i].frame, recognition.places[place]);
      row.push_back(is_true == MatchTruth::True ? 2.0 : is_true == MatchTruth::NotJudged ? 1.0 : 0.0);
    }
    thumbnail.add_row(i, row);
  }
  return thumbnail;
}

}  // namespace fabloop
