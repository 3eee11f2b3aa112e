// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "frontend/drawing.h"
#include "frontend/error.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace plot {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kTickLength = 5, kLineThickness = 2;

int text_thickness(double size) { return size < 0.9 ? 1 : 2; }

int text_height(double size) { return cv::getTextSize("0", kFont, size, text_thickness(size), nullptr).height; }

int rounded(double value) { return static_cast<int>(std::lround(value)); }

}  // namespace

std::vector<double> ticks(double low, double high, int wanted) {
  std::vector<double> result;
  if (!(high > low)) return {low};
  const double power = std::pow(10.0, std::floor(std::log10((high - low) / wanted)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if ((high - low) / (factor * power) <= wanted + 1) step = factor * power;
  }
  constexpr double kRounding = 1e-9;
  for (double i = std::ceil(low / step - kRounding); i * step <= high + kRounding * step; ++i) result.push_back(i * step);
  return result;
}

std::string tick_text(double value) {
  constexpr double kZero = 1e-12;
  std::ostringstream text;
  text.precision(6);
  text << (std::abs(value) < kZero ? 0.0 : value);
  return text.str();
}

int text_width(const std::string& text, double size) {
  return cv::getTextSize(text, kFont, size, text_thickness(size), nullptr).width;
}

void write(cv::Mat& picture, const std::string& text, const cv::Point& at, double align, double size) {
  const int left = at.x - rounded(align * text_width(text, size));
  cv::putText(picture, text, {left, at.y}, kFont, size, kInk, text_thickness(size), cv::LINE_AA);
}

void write_upwards(cv::Mat& picture, const std::string& text, const cv::Point& centre, double size) {
  const int width = text_width(text, size);
  const int height = 2 * text_height(size);
  cv::Mat line(height, width, CV_8UC3, kPaper);
  write(line, text, {0, height * 3 / 4}, 0.0, size);
  cv::rotate(line, line, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect wanted(centre.x - line.cols / 2, centre.y - line.rows / 2, line.cols, line.rows);
  const cv::Rect visible = wanted & cv::Rect(0, 0, picture.cols, picture.rows);
  if (!visible.empty()) line(visible - wanted.tl()).copyTo(picture(visible));
}

void draw_scale_bar(cv::Mat& picture, const cv::Point2d& right_end, double px_per_unit, double max_width_px,
                    const std::string& unit, double size) {
  const double longest = max_width_px / px_per_unit;
  const double power = std::pow(10.0, std::floor(std::log10(longest)));
  double length = power;
  for (const double factor : {2.0, 5.0}) {
    if (factor * power <= longest) length = factor * power;
  }
  const cv::Point2d left_end = right_end - cv::Point2d(length * px_per_unit, 0);
  const cv::Point2d tick(0, 11 * size);
  const int thickness = std::max(2, rounded(4 * size));
  draw::line(picture, left_end, right_end, kInk, thickness);
  for (const cv::Point2d& end : {left_end, right_end}) draw::line(picture, end - tick, end + tick, kInk, thickness);
  write(picture, tick_text(length) + " " + unit, {rounded(0.5 * (left_end.x + right_end.x)), rounded(right_end.y - 20 * size)},
        0.5, size);
}

void draw_axes(cv::Mat& picture, const Axis& x, const Axis& y) {
  const int left = std::min(x.begin, x.end), right = std::max(x.begin, x.end);
  const int top = std::min(y.begin, y.end), bottom = std::max(y.begin, y.end);
  cv::rectangle(picture, {left - 1, top - 1}, {right, bottom}, kInk);
  for (const double value : ticks(x.low, x.high)) {
    const int at = rounded(x.pixel(value));
    cv::line(picture, {at, bottom}, {at, bottom + kTickLength}, kInk);
    write(picture, tick_text(value), {at, bottom + kTickLength + 16}, 0.5);
  }
  int widest = 0;
  for (const double value : ticks(y.low, y.high)) {
    const int at = rounded(y.pixel(value));
    cv::line(picture, {left - 1 - kTickLength, at}, {left - 1, at}, kInk);
    write(picture, tick_text(value), {left - kTickLength - 5, at + text_height(kLabelSize) / 2}, 1.0);
    widest = std::max(widest, text_width(tick_text(value)));
  }
  write(picture, x.label, {(left + right) / 2, bottom + kTickLength + 38}, 0.5);
  write_upwards(picture, y.label, {left - kTickLength - widest - 20, (top + bottom) / 2});
}

LineStyle series_style(std::size_t i) {
  static const std::array<cv::Scalar, 7> kColours = {cv::Scalar(200, 90, 20),   cv::Scalar(0, 94, 213),  cv::Scalar(115, 158, 0),
                                                     cv::Scalar(167, 121, 204), cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86),
                                                     cv::Scalar(40, 40, 40)};
  static const std::array<std::vector<double>, 3> kDashes = {std::vector<double>{}, {10.0, 7.0}, {2.0, 6.0}};
  static_assert(kColours.size() * kDashes.size() == kNumStyles);
  return {kColours[i % kColours.size()], kDashes[i / kColours.size() % kDashes.size()]};
}

void draw_series(cv::Mat& picture, const std::vector<cv::Point2d>& path, const LineStyle& style) {
  draw::dashed_polyline(picture, path, style.dashes_px, style.colour, kLineThickness);
}

void draw_mark(cv::Mat& picture, const cv::Point2d& at, const LineStyle& style) {
  constexpr double kRadiusPx = 4;
  draw::disc(picture, at, kRadiusPx, style.dashes_px.empty() ? style.colour : kPaper);
  draw::circle(picture, at, kRadiusPx, style.colour, kLineThickness);
}

void write_legend(cv::Mat& picture, const std::string& text, const cv::Point& at, const LineStyle& style) {
  constexpr int kSample = 34, kGap = 10, kHalfText = 5;
  draw_series(picture, {cv::Point(at.x, at.y - kHalfText), cv::Point(at.x + kSample, at.y - kHalfText)}, style);
  write(picture, text, {at.x + kSample + kGap, at.y});
}

std::vector<std::string> wrapped(const std::string& text, int max_width, double size) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (lines.empty() || text_width(longer, size) > max_width) {
      lines.push_back(word);
    } else {
      lines.back() = longer;
    }
  }
  return lines;
}

}  // namespace plot

void write_png(const std::filesystem::path& path, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw InputError(path.string() + ": the picture could not be encoded as PNG");
  OutputFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

}  // namespace fabloop
