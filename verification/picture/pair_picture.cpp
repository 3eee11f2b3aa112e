// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/pair_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"
#include "verification/picture/epipolar_curve.h"
#include "verification/picture/pair_canvas.h"

namespace fabloop {
namespace {

constexpr int kMargin = 8;
constexpr int kLineHeight = 22;
const cv::Scalar kGreen(80, 220, 90), kRed(70, 70, 235), kGood(60, 130, 20), kBad(50, 40, 190);

const cv::Point2f& pixel_in(const View& view, int index) { return view.features.keypoints[static_cast<std::size_t>(index)].pt; }

/// Lines between the partners, so faint that many do not hide the images, and dots at their ends.
void draw_matches(const PictureOfPair& pair, const std::vector<Match>& matches, const cv::Scalar& colour, double opacity,
                  PairCanvas& canvas) {
  cv::Mat lines = canvas.picture.clone();
  for (const Match& m : matches) {
    draw::line(lines, canvas.in_query(pixel_in(pair.query, m.query)), canvas.in_match(pixel_in(pair.match, m.match)), colour);
  }
  cv::addWeighted(lines, opacity, canvas.picture, 1.0 - opacity, 0, canvas.picture);
}

void draw_dots(const PictureOfPair& pair, const std::vector<Match>& matches, const cv::Scalar& colour, PairCanvas& canvas) {
  constexpr double kRadiusPx = 2.3;
  for (const Match& m : matches) {
    for (const cv::Point2d& end :
         {canvas.in_query(pixel_in(pair.query, m.query)), canvas.in_match(pixel_in(pair.match, m.match))}) {
      draw::disc(canvas.picture, end, kRadiusPx, colour);
    }
  }
}

std::vector<Match> rejected(const PictureOfPair& pair) {
  std::set<std::pair<int, int>> inliers;
  for (const Match& m : pair.found.inliers) inliers.emplace(m.query, m.match);
  std::vector<Match> others;
  for (const Match& m : pair.matches) {
    if (!inliers.contains({m.query, m.match})) others.push_back(m);
  }
  return others;
}

/// Inliers far from each other in the query's image: each the furthest from those before it.
std::vector<Match> spread_out(const PictureOfPair& pair, std::size_t count) {
  const std::vector<Match>& all = pair.found.inliers;
  std::vector<Match> chosen;
  std::vector<double> to_chosen(all.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (chosen.size() < std::min(count, all.size())) {
    chosen.push_back(all[next]);
    for (std::size_t i = 0; i < all.size(); ++i) {
      to_chosen[i] =
          std::min(to_chosen[i], cv::norm(pixel_in(pair.query, all[i].query) - pixel_in(pair.query, chosen.back().query)));
    }
    next = static_cast<std::size_t>(std::max_element(to_chosen.begin(), to_chosen.end()) - to_chosen.begin());
  }
  return chosen;
}

/// Colours that can be told apart, bright on the dimmed image.
std::vector<cv::Scalar> make_colours(std::size_t count) {
  std::vector<cv::Scalar> colours;
  for (std::size_t i = 0; i < count; ++i) {
    const auto hue = static_cast<std::uint8_t>(180 * i / count);
    cv::Mat3b colour(1, 1, cv::Vec3b(hue, i % 2 == 0 ? 255 : 150, 255));
    cv::cvtColor(colour, colour, cv::COLOR_HSV2BGR);
    colours.emplace_back(colour(0, 0));
  }
  return colours;
}

/// Cut off at the image's edges.
void draw_curves(const std::vector<std::vector<cv::Point2f>>& pieces, const cv::Rect& place, double scale,
                 const cv::Scalar& colour, cv::Mat& picture) {
  cv::Mat image = picture(place);
  for (const auto& piece : pieces) {
    std::vector<cv::Point2d> points;
    for (const cv::Point2f& pixel : piece) points.push_back(PairCanvas::at({}, scale, pixel));
    draw::polyline(image, points, colour);
  }
}

void draw_epipolar_lines(const PictureOfPair& pair, std::size_t count, PairCanvas& canvas) {
  constexpr double kRadiusPx = 5.0;
  const std::vector<Match> chosen = spread_out(pair, count);
  const std::vector<cv::Scalar> colours = make_colours(chosen.size());
  const Pose& match_from_query = pair.found.match_from_query;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto q = static_cast<std::size_t>(chosen[i].query), m = static_cast<std::size_t>(chosen[i].match);
    draw_curves(epipolar_curve(pair.query.rays[q], match_from_query, pair.match.camera), canvas.match_place, canvas.match_scale,
                colours[i], canvas.picture);
    draw_curves(epipolar_curve(pair.match.rays[m], match_from_query.inverse(), pair.query.camera), canvas.query_place,
                canvas.query_scale, colours[i], canvas.picture);
    for (const cv::Point2d& end :
         {canvas.in_query(pixel_in(pair.query, chosen[i].query)), canvas.in_match(pixel_in(pair.match, chosen[i].match))}) {
      draw::circle(canvas.picture, end, kRadiusPx, colours[i], 2);
    }
  }
}

cv::Mat paper(int height, int width) { return cv::Mat(height, width, CV_8UC3, plot::kPaper); }

/// One line, beginning at the left edge of each image.
cv::Mat two_texts(const PairCanvas& canvas, const std::string& left, const std::string& right) {
  cv::Mat strip = paper(kLineHeight + 4, canvas.picture.cols);
  plot::write(strip, left, {canvas.query_place.x + kMargin, kLineHeight - 4});
  plot::write(strip, right, {canvas.match_place.x + kMargin, kLineHeight - 4});
  return strip;
}

/// The verdict in its colour, and the remarks.
cv::Mat verdict_text(int width, const PictureOfPair& pair) {
  std::vector<std::string> lines;
  for (const std::string& remark : pair.remarks) {
    for (const std::string& line : plot::wrapped(remark, width - 2 * kMargin)) lines.push_back(line);
  }
  cv::Mat block = paper(kLineHeight * (static_cast<int>(lines.size()) + 1) + kMargin, width);
  const cv::Scalar& colour = pair.found.verdict == Verdict::Accepted ? kGood : kBad;
  cv::putText(block, std::string(to_string(pair.found.verdict)), {kMargin, kLineHeight - 2}, cv::FONT_HERSHEY_SIMPLEX,
              plot::kTitleSize, colour, 1, cv::LINE_AA);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    plot::write(block, lines[i], {kMargin, kLineHeight * (static_cast<int>(i) + 2) - 2});
  }
  return block;
}

/// The figures that are known in two columns, and in red what was wanted in vain.
cv::Mat figure_table(int width, const std::vector<PairFigure>& figures) {
  constexpr int kValueEnd = 270, kWantedBegin = 290;
  std::vector<PairFigure> known;
  std::copy_if(figures.begin(), figures.end(), std::back_inserter(known),
               [](const auto& figure) { return figure.value.has_value(); });
  const int num_rows = (static_cast<int>(known.size()) + 1) / 2;
  cv::Mat table = paper(kLineHeight * num_rows + kMargin, width);
  for (int i = 0; i < static_cast<int>(known.size()); ++i) {
    const PairFigure& figure = known[static_cast<std::size_t>(i)];
    const int left = kMargin + (i / num_rows) * (width / 2 + kPairGapPx / 2), baseline = kLineHeight * (i % num_rows + 1) - 6;
    plot::write(table, std::string(figure.name), {left, baseline});
    plot::write(table, value_text(figure), {left + kValueEnd, baseline}, 1.0);
    const auto passed = figure.is_passed();
    if (!passed) continue;
    const std::string text = *passed ? wanted_text(figure) : wanted_text(figure) + ": FAILS";
    cv::putText(table, text, {left + kWantedBegin, baseline}, cv::FONT_HERSHEY_SIMPLEX, plot::kLabelSize, *passed ? kGood : kBad,
                1, cv::LINE_AA);
  }
  return table;
}

/// Fainter the more there are.
double opacity_of(std::size_t num_lines) {
  constexpr double kMost = 0.6, kLeast = 0.25, kLinesAtFull = 75;
  return std::clamp(kLinesAtFull / static_cast<double>(std::max<std::size_t>(num_lines, 1)), kLeast, kMost);
}

}  // namespace

cv::Mat draw_pair(const PictureOfPair& pair, const PairPictureOptions& options) {
  assert(pair.query_gray.type() == CV_8UC1 && pair.match_gray.type() == CV_8UC1);
  assert(pair.query_gray.cols == pair.query.camera.width && pair.match_gray.cols == pair.match.camera.width);
  PairCanvas matches = make_pair_canvas(pair.query_gray, pair.match_gray, options.image_width_px);
  const std::vector<Match> others = rejected(pair);
  constexpr double kFaint = 0.5;
  draw_matches(pair, others, kRed, kFaint * opacity_of(others.size()), matches);
  draw_matches(pair, pair.found.inliers, kGreen, opacity_of(pair.found.inliers.size()), matches);
  draw_dots(pair, others, kRed, matches);
  draw_dots(pair, pair.found.inliers, kGreen, matches);
  const int width = matches.picture.cols;
  const std::string counts = std::to_string(pair.found.inliers.size()) + " inliers (green), " + std::to_string(others.size()) +
                             " rejected matches (red)";
  std::vector<cv::Mat> rows = {two_texts(matches, "A: " + pair.query_name, "B: " + pair.match_name), matches.picture,
                               two_texts(matches, counts, "")};
  if (!pair.found.inliers.empty() && pair.found.match_from_query.translation.norm() > 0) {
    PairCanvas lines = make_pair_canvas(pair.query_gray, pair.match_gray, options.image_width_px);
    draw_epipolar_lines(pair, static_cast<std::size_t>(options.num_epipolar_lines), lines);
    rows.push_back(lines.picture);
    rows.push_back(two_texts(lines, "some inliers, and the lines on which their partners put them", ""));
  }
  rows.push_back(verdict_text(width, pair));
  rows.push_back(figure_table(width, pair.figures));
  cv::Mat picture;
  cv::vconcat(rows, picture);
  return picture;
}

}  // namespace fabloop
