// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "frontend/drawing.h"
#include "frontend/recognition/plot.h"
#include "posegraph/run/run_folder.h"

namespace fabloop {
namespace {

constexpr int kWidth = 1400;
constexpr int kPlotHeight = 1000;
constexpr int kMargin = 60;
constexpr int kLegendHeight = 90;
constexpr double kTextSize = 0.55;

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
      if (!gap) draw::line(picture, a + (b - a) * (1.0 * k / pieces), a + (b - a) * (1.0 * (k + 1) / pieces), colour, thickness);
    }
    along += length;
  }
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
  plot::write(picture, title, {kMargin, kPlotHeight + 25}, 0.0, 0.65);
  int x = kMargin;
  for (const LegendEntry& entry : entries) {
    const int y = kPlotHeight + 60;
    for (int k = 0; k < 4; ++k) {
      if (entry.dashed && k % 2 == 1) continue;
      draw::line(picture, cv::Point2d(x + 8 * k, y - 5), cv::Point2d(x + 8 * (k + 1), y - 5), entry.colour, 3);
    }
    plot::write(picture, entry.text, {x + 40, y}, 0.0, kTextSize);
    x += 65 + plot::text_width(entry.text, kTextSize);
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
        draw::line(lines, project(result[vertex_of(event.query)]), project(result[vertex_of(outcome.match)]),
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
  cv::Mat picture(kPlotHeight + kLegendHeight, kWidth, CV_8UC3, plot::kPaper);
  const Projection project({&odometry, &result, &reference});
  draw_loops(picture, project, result, map);
  draw_path(picture, project, odometry, kOdometry, 2, false);
  draw_path(picture, project, result, kResult, 2, false);
  draw_path(picture, project, reference, kReference, 1, true);
  for (const Eigen::Vector3d& x : result) draw::disc(picture, project(x), 2, kResult);
  const cv::Point2d start = project(result.front());
  draw::circle(picture, start, 7, kResult, 2);
  plot::write(picture, "start", {static_cast<int>(start.x) + 10, static_cast<int>(start.y) - 8}, 0.0, kTextSize);
  plot::draw_scale_bar(picture, cv::Point2d(kWidth - kMargin, kPlotHeight - 25), project.px_per_m(), 0.2 * kWidth, "m",
                       kTextSize);
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
