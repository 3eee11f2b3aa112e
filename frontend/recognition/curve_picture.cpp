// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/curve_picture.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <vector>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kWidth = 900, kPlotHeight = 560;
constexpr int kLeft = 90, kTop = 100, kRight = 40, kAxisText = 60, kLine = 20, kFoot = 15;
constexpr double kFootSize = 0.45;

const cv::Scalar kCurve(200, 90, 20);
const cv::Scalar kFullPrecision(70, 160, 40);

std::string percent(double part) {
  std::ostringstream text;
  text.precision(1);
  text << std::fixed << 100.0 * part << " %";
  return text.str();
}

std::string figures(const PrecisionRecall& result) {
  if (!result.curve) return "no query has a true match";
  std::ostringstream text;
  text << "average precision " << percent(result.curve->average_precision) << ", recall at 100 % precision "
       << percent(result.curve->recall_at_full_precision);
  for (const RecallAt& at : result.recall_at) text << ", recall@" << at.k << ' ' << percent(at.recall);
  return text.str();
}

void draw_curve(cv::Mat& canvas, const PrecisionRecallCurve& curve, const plot::Axis& recall, const plot::Axis& precision) {
  std::vector<cv::Point2d> path;
  for (const PrecisionRecallPoint& point : curve.points) {
    if (path.empty()) path.emplace_back(recall.pixel(0.0), precision.pixel(point.precision));
    path.emplace_back(recall.pixel(point.recall), precision.pixel(point.precision));
  }
  draw::polyline(canvas, path, kCurve, 2);
  if (curve.full_precision_threshold) {
    constexpr double kRadiusPx = 5;
    draw::disc(canvas, {recall.pixel(curve.recall_at_full_precision), precision.pixel(1.0)}, kRadiusPx, kFullPrecision);
  }
}

}  // namespace

cv::Mat draw_precision_recall(const std::string& title, const PrecisionRecall& result) {
  const std::vector<std::string> recipe = plot::wrapped(result.recipe, kWidth - kLeft - kRight, kFootSize);
  const int foot = kAxisText + kLine * static_cast<int>(recipe.size()) + kFoot;
  cv::Mat canvas(kTop + kPlotHeight + foot, kWidth, CV_8UC3, plot::kPaper);
  const plot::Axis recall{0.0, 1.0, kLeft, kWidth - kRight, "recall"};
  const plot::Axis precision{0.0, 1.0, kTop + kPlotHeight, kTop, "precision"};
  for (const double value : plot::ticks(0.0, 1.0)) {
    const int x = static_cast<int>(std::lround(recall.pixel(value)));
    const int y = static_cast<int>(std::lround(precision.pixel(value)));
    cv::line(canvas, {x, kTop}, {x, kTop + kPlotHeight}, plot::kGrid);
    cv::line(canvas, {kLeft, y}, {kWidth - kRight, y}, plot::kGrid);
  }
  plot::draw_axes(canvas, recall, precision);
  if (result.curve) draw_curve(canvas, *result.curve, recall, precision);
  plot::write(canvas, title, {kLeft, 30}, 0.0, plot::kTitleSize);
  const std::vector<std::string> lines = plot::wrapped(figures(result), kWidth - kLeft - kRight);
  for (std::size_t i = 0; i < lines.size(); ++i) plot::write(canvas, lines[i], {kLeft, 58 + kLine * static_cast<int>(i)});
  for (std::size_t i = 0; i < recipe.size(); ++i) {
    plot::write(canvas, recipe[i], {kLeft, kTop + kPlotHeight + kAxisText + kLine * static_cast<int>(i + 1)}, 0.0, kFootSize);
  }
  return canvas;
}

}  // namespace fabloop
