// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "frontend/recognition/plot.h"
#include "posegraph/run_folder.h"

namespace fabloop {
namespace {

constexpr int kWidth = 1400;
constexpr int kPlotHeight = 1000;
constexpr int kMargin = 60;
constexpr int kLegendHeight = 90;
constexpr int kSubpixelBits = 4;

const cv::Scalar kBackground(255, 255, 255);
const cv::Scalar kInk(50, 50, 50);
const cv::Scalar kOdometry(165, 165, 165);
const cv::Scalar kReference(60, 60, 60);
const cv::Scalar kResult(200, 90, 20);      // blue
const cv::Scalar kAccepted(70, 160, 40);    // green
const cv::Scalar kRejected(205, 205, 250);  // faint red

using Path = std::vector<Eigen::Vector3d>;

/// Camera centres, moved by the alignment where there is one.
Path centres(const Trajectory& trajectory, const std::optional<AbsoluteTrajectoryError>& error) {
  Path path;
  for (const StampedPose& pose : trajectory) {
    Eigen::Vector3d x = pose.world_from_camera.translation;
    if (error) x = error->reference_from_estimate.rotation * x + error->reference_from_estimate.translation;
    path.push_back(x);
  }
  return path;
}

/// The two axes in which the paths extend most, and how they land on the picture.
class Projection {
 public:
  explicit Projection(const std::vector<const Path*>& paths) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
    Eigen::Vector3d high = -low;
    for (const Path* path : paths) {
      for (const Eigen::Vector3d& x : *path) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
      }
    }
    const Eigen::Vector3d extent = high - low;
    Eigen::Index least = 0;
    // Height above ground varies least in nearly every sequence; z is preferred where extents are alike.
    if (extent.z() <= extent.x() || extent.z() <= extent.y()) least = 2;
    if (extent.y() < 0.5 * extent(least)) least = 1;
    first_ = least == 0 ? 1 : 0;
    second_ = least == 2 ? 1 : 2;
    const double width = std::max(extent(first_), 1e-6);
    const double height = std::max(extent(second_), 1e-6);
    px_per_m_ = std::min((kWidth - 2 * kMargin) / width, (kPlotHeight - 2 * kMargin) / height);
    centre_ = 0.5 * (low + high);
  }

  cv::Point2d operator()(const Eigen::Vector3d& x) const {
    return {0.5 * kWidth + px_per_m_ * (x(first_) - centre_(first_)),
            0.5 * kPlotHeight - px_per_m_ * (x(second_) - centre_(second_))};
  }

  double px_per_m() const { return px_per_m_; }

 private:
  Eigen::Index first_ = 0, second_ = 1;
  double px_per_m_ = 1;
  Eigen::Vector3d centre_;
};

cv::Point subpixel(const cv::Point2d& p) {
  constexpr double kScale = 1 << kSubpixelBits;
  return {static_cast<int>(std::lround(p.x * kScale)), static_cast<int>(std::lround(p.y * kScale))};
}

void draw_line(cv::Mat& picture, const cv::Point2d& a, const cv::Point2d& b, const cv::Scalar& colour, int thickness) {
  cv::line(picture, subpixel(a), subpixel(b), colour, thickness, cv::LINE_AA, kSubpixelBits);
}

void draw_path(cv::Mat& picture, const Projection& project, const Path& path, const cv::Scalar& colour, int thickness,
               bool dashed) {
  constexpr double kDashPx = 7;
  double along = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const cv::Point2d a = project(path[i - 1]);
    const cv::Point2d b = project(path[i]);
    const double length = cv::norm(b - a);
    const int pieces = dashed ? std::max(1, static_cast<int>(std::ceil(length / kDashPx))) : 1;
    for (int k = 0; k < pieces; ++k) {
      const bool gap = dashed && static_cast<int>((along + k * length / pieces) / kDashPx) % 2 == 1;
      if (!gap) draw_line(picture, a + (b - a) * (1.0 * k / pieces), a + (b - a) * (1.0 * (k + 1) / pieces), colour, thickness);
    }
    along += length;
  }
}

void write_text(cv::Mat& picture, const std::string& text, const cv::Point& at, double scale = 0.55) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, 1, cv::LINE_AA);
}

/// A round length that takes about a fifth of the picture.
double scale_bar_length(double px_per_m) {
  const double wanted = 0.2 * kWidth / px_per_m;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= wanted) return step * power;
  }
  return power;
}

void draw_scale_bar(cv::Mat& picture, double px_per_m) {
  const double length = scale_bar_length(px_per_m);
  const cv::Point2d end(kWidth - kMargin, kPlotHeight - 25);
  const cv::Point2d start = end - cv::Point2d(length * px_per_m, 0);
  draw_line(picture, start, end, kInk, 2);
  for (const cv::Point2d& p : {start, end}) draw_line(picture, p - cv::Point2d(0, 5), p + cv::Point2d(0, 5), kInk, 2);
  std::string text = std::to_string(length);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  write_text(picture, text + " m", {static_cast<int>(start.x), kPlotHeight - 35});
}

std::string metres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f m", value);
  return text.data();
}

struct LegendEntry {
  cv::Scalar colour;
  std::string text;
  bool dashed = false;
};

void draw_legend(cv::Mat& picture, const std::string& title, const std::vector<LegendEntry>& entries) {
  write_text(picture, title, {kMargin, kPlotHeight + 25}, 0.65);
  int x = kMargin;
  for (const LegendEntry& entry : entries) {
    const int y = kPlotHeight + 60;
    for (int k = 0; k < 4; ++k) {
      if (entry.dashed && k % 2 == 1) continue;
      draw_line(picture, cv::Point2d(x + 8 * k, y - 5), cv::Point2d(x + 8 * (k + 1), y - 5), entry.colour, 3);
    }
    write_text(picture, entry.text, {x + 40, y});
    int baseline = 0;
    x += 65 + cv::getTextSize(entry.text, cv::FONT_HERSHEY_SIMPLEX, 0.55, 1, &baseline).width;
  }
}

void draw_loops(cv::Mat& picture, const Projection& project, const Path& result, const Map& map) {
  const auto vertex_of = [&](std::size_t frame) {
    const auto& vertices = map.graph.vertices;
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), static_cast<std::int64_t>(frame),
                                        [](const Vertex& vertex, std::int64_t id) { return vertex.id < id; });
    return static_cast<std::size_t>(found - vertices.begin());
  };
  for (const bool accepted : {false, true}) {
    cv::Mat lines = picture.clone();
    for (const LoopEvent& event : map.events) {
      for (const HypothesisOutcome& outcome : event.hypotheses) {
        const bool is_within = outcome.match_session == event.session;
        if (!is_within || (outcome.verification.verdict == Verdict::Accepted) != accepted) continue;
        draw_line(lines, project(result[vertex_of(event.query)]), project(result[vertex_of(outcome.match)]),
                  accepted ? kAccepted : kRejected, 1);
      }
    }
    constexpr double kOpacity = 0.45;  // a thousand loops must not hide the path
    cv::addWeighted(lines, kOpacity, picture, 1.0 - kOpacity, 0.0, picture);
  }
}

}  // namespace

cv::Mat draw_map(const Sequence& sequence, const Map& map) {
  const RunErrors errors = run_errors(sequence, map);
  const Path odometry = centres(map.odometry_trajectory, errors.odometry);
  const Path result = centres(map.final_trajectory, errors.final);
  Path reference;
  for (const Frame& frame : sequence.frames) {
    if (frame.world_from_camera) reference.push_back(frame.world_from_camera->translation);
  }
  const bool has_reference = errors.final.has_value();
  if (!has_reference) reference.clear();
  cv::Mat picture(kPlotHeight + kLegendHeight, kWidth, CV_8UC3, kBackground);
  const Projection project({&odometry, &result, &reference});
  draw_loops(picture, project, result, map);
  draw_path(picture, project, odometry, kOdometry, 2, false);
  draw_path(picture, project, result, kResult, 2, false);
  draw_path(picture, project, reference, kReference, 1, true);
  for (const Eigen::Vector3d& x : result)
    cv::circle(picture, subpixel(project(x)), 2 << kSubpixelBits, kResult, -1, cv::LINE_AA, kSubpixelBits);
  cv::circle(picture, subpixel(project(result.front())), 7 << kSubpixelBits, kResult, 2, cv::LINE_AA, kSubpixelBits);
  write_text(picture, "start",
             {static_cast<int>(project(result.front()).x) + 10, static_cast<int>(project(result.front()).y) - 8});
  draw_scale_bar(picture, project.px_per_m());
  const LoopCounts counts = count_loops(map);
  std::vector<LegendEntry> legend = {
      {kResult, "result" + (has_reference ? ", ATE " + metres(errors.final->translation_m.rmse) : "")},
      {kOdometry, "odometry" + (has_reference ? ", ATE " + metres(errors.odometry->translation_m.rmse) : "")}};
  if (has_reference) legend.push_back({kReference, "reference", true});
  legend.push_back({kAccepted, std::to_string(counts.num_accepted) + " loops accepted"});
  legend.push_back({kRejected, std::to_string(counts.num_hypotheses - counts.num_accepted) + " rejected"});
  draw_legend(picture, sequence.name, legend);
  return picture;
}

void write_map_picture(const std::filesystem::path& path, const Sequence& sequence, const Map& map) {
  write_png(path, draw_map(sequence, map));
}

}  // namespace fabloop
