// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_figures.h"

#include <algorithm>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "frontend/drawing.h"
#include "frontend/recognition/curve_picture.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kWidth = 900, kPlotHeight = 480;
constexpr int kLeft = 90, kFirstLine = 58, kLine = 20, kRight = 40, kFoot = 70;

/// What one stage lets through against the swept parameter; a point where anything judged passed.
struct Series {
  std::string name;
  std::vector<cv::Point2d> points;
};

std::vector<Series> false_shares(const std::vector<const MethodRows*>& groups) {
  std::vector<Series> all;
  for (const MethodRows* rows : groups) {
    for (const StageRow& row : rows->stages) {
      auto found = std::find_if(all.begin(), all.end(), [&](const Series& series) { return series.name == row.stage; });
      if (found == all.end()) found = all.insert(all.end(), {row.stage, {}});
      if (const auto& precision = row.result.precision.value)
        found->points.emplace_back(rows->swept.front().second, 1.0 - *precision);
    }
  }
  return all;
}

/// "geometry: 0, 1.6, 12.1 %": lines that coincide hide one another, so the legend has their values too.
std::string legend_of(const Series& series) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << series.name << ": ";
  for (std::size_t i = 0; i < series.points.size(); ++i) text << (i > 0 ? ", " : "") << 100.0 * series.points[i].y;
  text << (series.points.empty() ? "nothing passed" : " %");
  return text.str();
}

/// `sweep` has at least two values, all of them different.
cv::Mat draw_series(const std::string& title, const LabSweep& sweep, const std::vector<Series>& all) {
  double most = 0.0;
  for (const Series& series : all) {
    for (const cv::Point2d& point : series.points) most = std::max(most, point.y);
  }
  const int top = kFirstLine + kLine * static_cast<int>(all.size());
  cv::Mat picture(top + kPlotHeight + kFoot, kWidth, CV_8UC3, plot::kPaper);
  // Over all values, so that one at which nothing passed is seen to have no point.
  const auto [low, high] = std::minmax_element(sweep.values.begin(), sweep.values.end());
  const plot::Axis x{*low, *high, kLeft, kWidth - kRight, std::string(sweep.parameter->name)};
  constexpr double kLeastRange = 0.01, kHeadroom = 1.05;
  const plot::Axis y{0.0, std::max(kLeastRange, kHeadroom * most), top + kPlotHeight, top,
                     "share of false ones among those that passed"};
  plot::draw_axes(picture, x, y);
  plot::write(picture, title, {kLeft, 30}, 0.0, plot::kTitleSize);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const plot::LineStyle style = plot::series_style(i);
    plot::write_legend(picture, legend_of(all[i]), {kLeft, kFirstLine + kLine * static_cast<int>(i)}, style);
    std::vector<cv::Point2d> path;
    for (const cv::Point2d& point : all[i].points) path.emplace_back(x.pixel(point.x), y.pixel(point.y));
    plot::draw_series(picture, path, style);
    for (const cv::Point2d& point : path) plot::draw_mark(picture, point, style);
  }
  return picture;
}

/// A picture for each sequence and method, where one parameter is swept and anything judged passed.
void write_false_shares(const std::filesystem::path& folder, const LabResults& results, const LabDescription& description) {
  if (description.sweep.size() != 1 || description.sweep.front().values.size() < 2) return;
  const std::size_t num_values = description.sweep.front().values.size(), num_methods = description.methods.size();
  for (std::size_t data = 0; data * num_values * num_methods < results.pooled.size(); ++data) {
    for (std::size_t m = 0; m < num_methods; ++m) {
      std::vector<const MethodRows*> groups;
      for (std::size_t v = 0; v < num_values; ++v) groups.push_back(&results.pooled[(data * num_values + v) * num_methods + m]);
      const MethodRows& rows = *groups.front();
      const std::vector<Series> shares = false_shares(groups);
      if (std::all_of(shares.begin(), shares.end(), [](const Series& series) { return series.points.empty(); })) continue;
      write_png(folder / ("false_share_" + rows.data + "_" + rows.method + ".png"),
                draw_series(description.title + ": " + rows.label, description.sweep.front(), shares));
    }
  }
}

}  // namespace

void write_lab_figures(const std::filesystem::path& folder, const LabResults& results, const LabDescription& description) {
  write_false_shares(folder, results, description);
  if (!description.has_stage(Stage::Appearance)) return;
  const std::size_t num_methods = description.methods.size();
  for (std::size_t first = 0; first < results.pooled.size(); first += num_methods) {
    std::vector<NamedCurve> curves;
    for (std::size_t m = first; m < first + num_methods; ++m) {
      const MethodRows& rows = results.pooled[m];
      const auto& curve = rows.stages.front().result.curve;
      curves.push_back({rows.label, curve ? &*curve : nullptr});
    }
    const MethodRows& rows = results.pooled[first];
    write_png(folder / ("precision_recall_" + std::to_string(first / num_methods + 1) + ".png"),
              draw_precision_recall(description.title + ": " + rows.group, curves, rows.recipe));
  }
}

}  // namespace fabloop
