// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/map_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"
#include "posegraph/evaluation/trajectory_error.h"

namespace fabloop {
namespace {

constexpr int kPanelWidth = 1400;
constexpr int kPanelHeight = 1400;
constexpr int kFigureMargin = 50;
constexpr int kHead = 110;
constexpr int kFoot = 150;
constexpr double kFigureTextSize = 1.0, kTitleSize = 1.1;  // for print

const cv::Scalar kOdometryTrack(120, 120, 120);
const cv::Scalar kTrack(20, 200, 255);  // amber: seen on grass, earth and asphalt alike
const cv::Scalar kLoop(60, 150, 30);

/// Frame to ground position, before and after.
using Positions = std::map<std::size_t, Eigen::Vector2d>;

Positions positions_after(const MapFigure& figure) {
  Positions positions;
  for (const PlacedImage& image : figure.reconstruction.images) {
    positions[image.frame] = (figure.ground_from_world * image.world_from_camera.translation).head<2>();
  }
  return positions;
}

/// The odometry moved and scaled onto the result as well as it fits; empty where there is none.
Positions positions_before(const MapFigure& figure) {
  std::map<std::int64_t, Eigen::Vector3d> at_time;
  for (const StampedPose& pose : figure.odometry) at_time[pose.time_ns] = pose.world_from_camera.translation;
  std::vector<std::size_t> frames;
  std::vector<Eigen::Vector3d> before, after;
  for (const PlacedImage& image : figure.reconstruction.images) {
    const auto found = at_time.find(image.time_ns);
    if (found == at_time.end()) continue;
    frames.push_back(image.frame);
    before.push_back(found->second);
    after.push_back(figure.ground_from_world * image.world_from_camera.translation);
  }
  Eigen::Matrix3Xd from(3, before.size()), onto(3, before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = before[i];
    onto.col(static_cast<Eigen::Index>(i)) = after[i];
  }
  Positions positions;
  const auto alignment = before.size() < 3 ? std::nullopt : align_points(from, onto, Alignment::Sim3);
  if (!alignment) return positions;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    positions[frames[i]] = (alignment->scale * (alignment->rotation * before[i]) + alignment->translation).head<2>();
  }
  return positions;
}

/// A panel of the figure: where ground positions land on it.
struct Panel {
  cv::Point2d corner;  ///< Of the drawn area.
  Eigen::Vector2d north_west;
  double px_per_unit = 1;

  cv::Point2d operator()(const Eigen::Vector2d& x) const {
    return corner + cv::Point2d((x.x() - north_west.x()) * px_per_unit, (north_west.y() - x.y()) * px_per_unit);
  }
};

void draw_loops(cv::Mat& picture, const Panel& panel, const Positions& positions, const std::vector<LoopLink>& loops,
                double opacity) {
  constexpr std::size_t kManyLoops = 300;
  cv::Mat lines = picture.clone();
  for (const LoopLink& loop : loops) {
    const auto query = positions.find(loop.query);
    const auto match = positions.find(loop.match);
    if (query == positions.end() || match == positions.end()) continue;
    draw::line(lines, panel(query->second), panel(match->second), kLoop, loops.size() > kManyLoops ? 1 : 2);
  }
  cv::addWeighted(lines, opacity, picture, 1 - opacity, 0.0, picture);
}

void draw_track(cv::Mat& picture, const Panel& panel, const Positions& positions, const cv::Scalar& colour,
                const cv::Scalar& halo) {
  for (const bool is_halo : {true, false}) {
    const cv::Point2d* before = nullptr;
    cv::Point2d last;
    for (const auto& [frame, x] : positions) {
      const cv::Point2d at = panel(x);
      if (before != nullptr) draw::line(picture, last, at, is_halo ? halo : colour, is_halo ? 7 : 3);
      last = at;
      before = &last;
    }
  }
  for (const auto& [frame, x] : positions) draw::disc(picture, panel(x), 4, colour);
  if (positions.empty()) return;
  const cv::Point2d start = panel(positions.begin()->second);
  draw::circle(picture, start, 14, plot::kPaper, 7);
  draw::circle(picture, start, 14, plot::kInk, 3);
}

void draw_texture(cv::Mat& picture, const Panel& panel, const GroundPicture& ground) {
  const double scale = ground.grid.spacing * panel.px_per_unit;
  const cv::Size size(std::max(1, static_cast<int>(std::lround(ground.colour.cols * scale))),
                      std::max(1, static_cast<int>(std::lround(ground.colour.rows * scale))));
  const auto way = scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC;
  cv::Mat colour, mask;
  // Weighted by what is shown, so that the border does not darken.
  cv::Mat shown;
  ground.shown.convertTo(shown, CV_32F, 1.0 / 255);
  cv::resize(ground.colour, colour, size, 0, 0, way);
  cv::resize(shown, mask, size, 0, 0, cv::INTER_AREA);
  const cv::Point2d corner = panel(ground.grid.ground_at(-0.5, -0.5));
  const cv::Rect all(0, 0, picture.cols, picture.rows);
  const cv::Rect place(static_cast<int>(std::lround(corner.x)), static_cast<int>(std::lround(corner.y)), size.width, size.height);
  const cv::Rect inside = place & all;
  const cv::Rect part(inside.x - place.x, inside.y - place.y, inside.width, inside.height);
  colour(part).copyTo(picture(inside), mask(part) > 0.99F);
}

struct FigureLegendEntry {
  cv::Scalar colour;
  std::string text;
};

void draw_foot(cv::Mat& picture, const Panel& panel, const std::vector<FigureLegendEntry>& entries, LengthUnit unit) {
  const int y = picture.rows - kFoot + 75;
  int x = kFigureMargin;
  for (const FigureLegendEntry& entry : entries) {
    draw::line(picture, cv::Point2d(x, y - 10), cv::Point2d(x + 50, y - 10), entry.colour, 6);
    plot::write(picture, entry.text, {x + 65, y}, 0.0, kFigureTextSize);
    x += 110 + plot::text_width(entry.text, kFigureTextSize);
  }
  plot::draw_scale_bar(picture, cv::Point2d(picture.cols - kFigureMargin, y + 25), panel.px_per_unit, 0.22 * kPanelWidth,
                       unit == LengthUnit::Metres ? "m" : "units", kFigureTextSize);
}

void draw_north(cv::Mat& picture, const cv::Point2d& at) {
  const cv::Point2d tip = at - cv::Point2d(0, 50);
  draw::line(picture, at, tip, plot::kInk, 4);
  draw::line(picture, tip, tip + cv::Point2d(-12, 20), plot::kInk, 4);
  draw::line(picture, tip, tip + cv::Point2d(12, 20), plot::kInk, 4);
  plot::write(picture, "N", {static_cast<int>(tip.x), static_cast<int>(tip.y) - 12}, 0.5, kFigureTextSize);
}

/// One panel or two of the same scale that hold everything drawn.
std::vector<Panel> lay_out(const MapFigure& figure, const Positions& before, const Positions& after, cv::Size& size) {
  const GroundGrid& grid = figure.picture.grid;
  const Eigen::Vector2d a = grid.ground_at(-0.5, -0.5);
  const Eigen::Vector2d b = grid.ground_at(grid.columns - 0.5, grid.rows - 0.5);
  Eigen::Vector2d low = a.cwiseMin(b);
  Eigen::Vector2d high = a.cwiseMax(b);
  for (const Positions* positions : {&before, &after}) {
    for (const auto& [frame, x] : *positions) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  const Eigen::Vector2d extent = high - low;
  const double px_per_unit = std::min(kPanelWidth / extent.x(), kPanelHeight / extent.y());
  const int width = static_cast<int>(std::ceil(extent.x() * px_per_unit));
  const int height = static_cast<int>(std::ceil(extent.y() * px_per_unit));
  const Eigen::Vector2d north_west(low.x(), high.y());
  std::vector<Panel> panels{{cv::Point2d(kFigureMargin, kHead), north_west, px_per_unit}};
  if (!before.empty()) panels.push_back({cv::Point2d(2 * kFigureMargin + width, kHead), north_west, px_per_unit});
  const int num_panels = static_cast<int>(panels.size());
  constexpr int kLeastWidth = 1500;  // of the legend
  size = {std::max(kLeastWidth, kFigureMargin + num_panels * (width + kFigureMargin)), kHead + height + kFoot};
  return panels;
}

}  // namespace

cv::Mat3b draw_map_figure(const MapFigure& figure) {
  const Positions before = positions_before(figure);
  const Positions after = positions_after(figure);
  cv::Size size;
  const std::vector<Panel> panels = lay_out(figure, before, after, size);
  cv::Mat picture(size, CV_8UC3, plot::kPaper);
  const Panel& map = panels.back();
  const std::string what = figure.loops.empty() ? "" : " and the " + std::to_string(figure.loops.size()) + " loops found";
  if (panels.size() > 1) {
    constexpr double kOverPaper = 0.7;
    draw_loops(picture, panels.front(), before, figure.loops, kOverPaper);
    draw_track(picture, panels.front(), before, kOdometryTrack, plot::kPaper);
    plot::write(picture, "before: odometry" + what, {kFigureMargin, kHead - 25}, 0.0, kTitleSize);
  }
  draw_texture(picture, map, figure.picture);
  constexpr double kOverTexture = 0.35;
  if (panels.size() == 1) draw_loops(picture, map, after, figure.loops, kOverTexture);
  draw_track(picture, map, after, kTrack, plot::kInk);
  plot::write(picture, (panels.size() > 1 ? "after: " : "") + std::string("textured map of ") + figure.title,
              {static_cast<int>(map.corner.x), kHead - 25}, 0.0, kTitleSize);
  std::vector<FigureLegendEntry> legend;
  if (panels.size() > 1) legend.push_back({kOdometryTrack, "odometry"});
  legend.push_back({kTrack, "trajectory"});
  if (!figure.loops.empty()) legend.push_back({kLoop, "loop"});
  draw_foot(picture, map, legend, figure.reconstruction.unit);
  if (figure.reconstruction.origin) draw_north(picture, {picture.cols - kFigureMargin - 20.0, kHead - 20.0});
  return picture;
}

void write_map_figure(const std::filesystem::path& path, const MapFigure& figure) { write_png(path, draw_map_figure(figure)); }

}  // namespace fabloop
