// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fabloop {

/// Colours and type of all plots (BGR, 8 bit).
namespace plot {

inline const cv::Scalar kPaper(255, 255, 255);
inline const cv::Scalar kInk(60, 60, 60);
inline const cv::Scalar kGrid(225, 225, 225);
inline constexpr double kLabelSize = 0.5;
inline constexpr double kTitleSize = 0.6;

/// An axis: values from `low` to `high` at pixels from `begin` to `end`.
struct Axis {
  double low = 0.0, high = 1.0;
  int begin = 0, end = 1;
  std::string label;

  double pixel(double value) const { return begin + (value - low) / (high - low) * (end - begin); }
};

/// Round values within [low, high], about `wanted` of them, 1, 2 or 5 times a power of ten apart.
std::vector<double> ticks(double low, double high, int wanted = 6);

/// "0.2", "1500": the shortest text that gives a tick's value.
std::string tick_text(double value);

/// Width in pixels of a text of that size.
int text_width(const std::string& text, double size = kLabelSize);

/// Writes left of, above or at a point: `align` is 0 for text that begins there, 0.5 for centred, 1 for text that ends there.
/// Large text is bold.
void write(cv::Mat& picture, const std::string& text, const cv::Point& at, double align = 0.0, double size = kLabelSize);

/// Writes upwards, centred at a point.
void write_upwards(cv::Mat& picture, const std::string& text, const cv::Point& centre, double size = kLabelSize);

/// A bar of a round length (1, 2 or 5 times a power of ten) of at most `max_width_px`, its right end at a point, its length and
/// unit written above in the given size, by which its strokes grow.
void draw_scale_bar(cv::Mat& picture, const cv::Point2d& right_end, double px_per_unit, double max_width_px,
                    const std::string& unit, double size = kLabelSize);

/// Frame, ticks and labels: x below the frame, y on its left.
void draw_axes(cv::Mat& picture, const Axis& x, const Axis& y);

/// How a line of a plot is told from the others.
struct LineStyle {
  cv::Scalar colour;
  std::vector<double> dashes_px;  ///< See draw::dashed_polyline().
};

/// Seven colours that people who see no red or green tell apart (blue first, then Okabe & Ito 2008), first as solid lines, then
/// dashed, then dotted; they repeat after kNumStyles.
inline constexpr std::size_t kNumStyles = 21;
LineStyle series_style(std::size_t i);

/// A line through points (pixels).
void draw_series(cv::Mat& picture, const std::vector<cv::Point2d>& path, const LineStyle& style);

/// A mark at a point: a disc on solid lines, a ring on broken ones.
void draw_mark(cv::Mat& picture, const cv::Point2d& at, const LineStyle& style);

/// A short line of the style, and what it stands for.
void write_legend(cv::Mat& picture, const std::string& text, const cv::Point& at, const LineStyle& style);

/// Lines of at most `max_width` pixels.
std::vector<std::string> wrapped(const std::string& text, int max_width, double size = kLabelSize);

}  // namespace plot

/// Writes a picture as PNG; the file appears only when it is complete. Throws InputError when it cannot be written.
void write_png(const std::filesystem::path& path, const cv::Mat& picture);

}  // namespace fabloop
