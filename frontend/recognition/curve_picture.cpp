// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/curve_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <vector>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kWidth = 900, kPlotHeight = 560;
constexpr int kLeft = 90, kFirstLine = 58, kRight = 40, kAxisText = 60, kLine = 20, kFoot = 15;
constexpr double kFootSize = 0.45;

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

void draw_curve(cv::Mat& canvas, const PrecisionRecallCurve& curve, const plot::LineStyle& style, const plot::Axis& recall,
                const plot::Axis& precision) {
  std::vector<cv::Point2d> path;
  for (const PrecisionRecallPoint& point : curve.points) {
    if (path.empty()) path.emplace_back(recall.pixel(0.0), precision.pixel(point.precision));
    path.emplace_back(recall.pixel(point.recall), precision.pixel(point.precision));
  }
  plot::draw_series(canvas, path, style);
}

/// Title, lines of text above the plot, grid and axes, and the recipe below.
struct Canvas {
  cv::Mat picture;
  plot::Axis recall, precision;
};

Canvas make_canvas(const std::string& title, int num_lines, const std::string& recipe) {
  const std::vector<std::string> lines = plot::wrapped(recipe, kWidth - kLeft - kRight, kFootSize);
  const int foot = kAxisText + kLine * static_cast<int>(lines.size()) + kFoot;
  const int top = kFirstLine + kLine * std::max(2, num_lines);
  Canvas canvas{cv::Mat(top + kPlotHeight + foot, kWidth, CV_8UC3, plot::kPaper),
                {0.0, 1.0, kLeft, kWidth - kRight, "recall"},
                {0.0, 1.0, top + kPlotHeight, top, "precision"}};
  for (const double value : plot::ticks(0.0, 1.0)) {
    const int x = static_cast<int>(std::lround(canvas.recall.pixel(value)));
    const int y = static_cast<int>(std::lround(canvas.precision.pixel(value)));
    cv::line(canvas.picture, {x, top}, {x, top + kPlotHeight}, plot::kGrid);
    cv::line(canvas.picture, {kLeft, y}, {kWidth - kRight, y}, plot::kGrid);
  }
  plot::draw_axes(canvas.picture, canvas.recall, canvas.precision);
  plot::write(canvas.picture, title, {kLeft, 30}, 0.0, plot::kTitleSize);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    plot::write(canvas.picture, lines[i], {kLeft, top + kPlotHeight + kAxisText + kLine * static_cast<int>(i + 1)}, 0.0,
                kFootSize);
  }
  return canvas;
}

std::string legend_of(const NamedCurve& named) {
  if (!named.curve) return named.name + ": no query has a true match";
  return named.name + ": AP " + percent(named.curve->average_precision) + ", recall at 100 % precision " +
         percent(named.curve->recall_at_full_precision);
}

}  // namespace

cv::Mat draw_precision_recall(const std::string& title, const PrecisionRecall& result) {
  const std::vector<std::string> lines = plot::wrapped(figures(result), kWidth - kLeft - kRight);
  Canvas canvas = make_canvas(title, static_cast<int>(lines.size()), result.recipe);
  for (std::size_t i = 0; i < lines.size(); ++i)
    plot::write(canvas.picture, lines[i], {kLeft, kFirstLine + kLine * static_cast<int>(i)});
  if (!result.curve) return canvas.picture;
  draw_curve(canvas.picture, *result.curve, plot::series_style(0), canvas.recall, canvas.precision);
  if (result.curve->full_precision_threshold) {
    constexpr double kRadiusPx = 5;
    draw::disc(canvas.picture, {canvas.recall.pixel(result.curve->recall_at_full_precision), canvas.precision.pixel(1.0)},
               kRadiusPx, kFullPrecision);
  }
  return canvas.picture;
}

cv::Mat draw_precision_recall(const std::string& title, const std::vector<NamedCurve>& curves, const std::string& recipe) {
  Canvas canvas = make_canvas(title, static_cast<int>(curves.size()), recipe);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const plot::LineStyle style = plot::series_style(i);
    const int y = kFirstLine + kLine * static_cast<int>(i);
    plot::write_legend(canvas.picture, legend_of(curves[i]), {kLeft, y}, style);
    if (curves[i].curve) draw_curve(canvas.picture, *curves[i].curve, style, canvas.recall, canvas.precision);
  }
  return canvas.picture;
}

}  // namespace fabloop
