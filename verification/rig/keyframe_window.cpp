// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/keyframe_window.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "verification/evidence.h"
#include "verification/rig/rig_pose.h"

namespace fabloop {
namespace {

void validate(std::span<const WindowView> window, const std::string& side) {
  if (window.empty()) throw InputError("keyframe window: the " + side + "'s window is empty; give it at least one view");
  for (std::size_t i = 0; i < window.size(); ++i) {
    const std::string where = "keyframe window: view " + std::to_string(i) + " of the " + side;
    if (window[i].view == nullptr) throw InputError(where + " is missing");
    const Pose& pose = window[i].window_from_camera;
    if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) throw InputError(where + " has no finite pose");
  }
}

RigRay ray_in_window(const WindowView& view, int feature) {
  return {view.window_from_camera.translation,
          view.window_from_camera.rotation * view.view->rays[static_cast<std::size_t>(feature)]};
}

/// The matches of every pair of views that share enough of them, the most distinctive first.
std::vector<WindowMatch> match_windows(std::span<const WindowView> query, std::span<const WindowView> match,
                                       const WindowOptions& options, WindowPose& result) {
  std::vector<WindowMatch> matches;
  for (std::size_t i = 0; i < query.size(); ++i) {
    for (std::size_t j = 0; j < match.size(); ++j) {
      const auto of_pair = match_features(query[i].view->features, match[j].view->features, options.matching);
      if (static_cast<int>(of_pair.size()) < options.min_matches) continue;
      ++result.num_view_pairs;
      for (const Match& m : of_pair) matches.push_back({i, j, m});
    }
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const WindowMatch& a, const WindowMatch& b) { return a.match.ratio < b.match.ratio; });
  result.num_matches = static_cast<int>(matches.size());
  return matches;
}

/// Different features among the matches' over the matches' features, counted once a match and side.
double share_of_independent_features(const std::vector<WindowMatch>& matches) {
  std::set<std::pair<std::size_t, int>> query_features, match_features;
  for (const WindowMatch& match : matches) {
    query_features.emplace(match.query_view, match.match.query);
    match_features.emplace(match.match_view, match.match.match);
  }
  return static_cast<double>(query_features.size() + match_features.size()) / static_cast<double>(2 * matches.size());
}

double mean_focal_px(std::span<const WindowView> window) {
  const double sum = std::accumulate(window.begin(), window.end(), 0.0,
                                     [](double total, const WindowView& view) { return total + feature_focal_px(*view.view); });
  return sum / static_cast<double>(window.size());
}

/// Of accidents among matches of different features, for a pose of five points and a sixth that gives up to ten of them.
double log10_accidents(const std::vector<WindowMatch>& matches, const std::vector<WindowMatch>& inliers, const View& view,
                       double max_error_px) {
  constexpr std::size_t kSampleSize = 6;
  constexpr double kModelsPerSample = 10;
  const auto count = [](const std::vector<WindowMatch>& of) {
    return static_cast<std::size_t>(share_of_independent_features(of) * static_cast<double>(of.size()));
  };
  const std::size_t num_inliers = count(inliers);
  return log10_false_alarms(std::max(count(matches), num_inliers), num_inliers, kSampleSize,
                            p_accidental_epipolar_match(view, max_error_px), kModelsPerSample);
}

}  // namespace

RefinedWindow refine_window(std::span<const WindowView> views, std::size_t anchor, const NeighbourOptions& options) {
  validate(views, "refined");
  if (anchor >= views.size()) throw InputError("keyframe window: the anchor is none of the window's views");
  RefinedWindow result{{views.begin(), views.end()}, 0};
  std::vector<Pose> first_from_camera(1);
  for (std::size_t i = 1; i < views.size(); ++i) {
    const Pose odometry = views[i - 1].window_from_camera.inverse() * views[i].window_from_camera;
    View previous = *views[i - 1].view, current = *views[i].view;  // their points are not ours to change
    const auto link = link_neighbours(previous, current, odometry, options);
    result.num_refined_steps += link.has_value();
    first_from_camera.push_back(first_from_camera.back() * (link ? link->previous_from_current : odometry));
  }
  const Pose window_from_first = views[anchor].window_from_camera * first_from_camera[anchor].inverse();
  for (std::size_t i = 0; i < views.size(); ++i) result.views[i].window_from_camera = window_from_first * first_from_camera[i];
  return result;
}

std::optional<WindowPose> verify_windows(std::span<const WindowView> query, std::span<const WindowView> match,
                                         const WindowOptions& options) {
  validate(query, "query");
  validate(match, "match");
  WindowPose result;
  const std::vector<WindowMatch> matches = match_windows(query, match, options, result);
  std::vector<RigRayPair> pairs;
  pairs.reserve(matches.size());
  for (const WindowMatch& m : matches) {
    pairs.push_back({ray_in_window(query[m.query_view], m.match.query), ray_in_window(match[m.match_view], m.match.match)});
  }
  const double focal_px = mean_focal_px(match);
  RigRelativePoseOptions rig_options;
  rig_options.max_error_rad = options.max_error_px / focal_px;
  rig_options.confidence = options.confidence;
  rig_options.max_iterations = options.max_iterations;
  rig_options.max_scale_sigma = options.max_scale_sigma;
  rig_options.seed = options.seed;
  const auto pose = estimate_rig_relative_pose(pairs, rig_options);
  if (!pose) return std::nullopt;
  for (const std::size_t i : pose->inliers) result.inliers.push_back(matches[i]);
  const double share = share_of_independent_features(result.inliers);
  result.match_from_query = pose->match_from_query;
  result.information = share * pose->information;
  result.scale_sigma = pose->scale_sigma / std::sqrt(share);
  result.has_scale = result.scale_sigma <= options.max_scale_sigma;
  result.log10_false_alarms = log10_accidents(matches, result.inliers, *match.front().view, options.max_error_px);
  result.rms_error_px = pose->rms_error_rad * focal_px;
  result.num_iterations = pose->iterations;
  return result;
}

}  // namespace fabloop
