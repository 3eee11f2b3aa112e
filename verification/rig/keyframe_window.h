// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/neighbour.h"
#include "verification/view.h"

namespace fabloop {

/// One view of a short window and where the odometry says it was: the views of a window are the cameras of a rig.
struct WindowView {
  const View* view = nullptr;  ///< Not null; must outlive the call.
  Pose window_from_camera;     ///< From the odometry; window is any frame that all views of the window share.
};

/// A window whose steps are the images' rather than the odometry's.
struct RefinedWindow {
  std::vector<WindowView> views;  ///< In the order given.
  int num_refined_steps = 0;      ///< Of one fewer than there are views: the other steps stay the odometry's.
};

/// Takes the rotation and the direction of each step from the images and its length from the odometry, as link_neighbours() does:
/// the shape of a window must be right to a pixel, and odometry's angles seldom are. Views in the order of their times; the pose
/// of `views[anchor]` stays. Throws InputError as verify_windows() does.
RefinedWindow refine_window(std::span<const WindowView> views, std::size_t anchor, const NeighbourOptions& options = {});

struct WindowOptions {
  MatchingOptions matching;
  double max_error_px = 2.0;     ///< Largest distance from the epipolar plane. As the verifier's.
  int min_matches = 15;          ///< Two views that share fewer are left out: chance alone makes a few.
  double confidence = 0.999;     ///< RANSAC's.
  int max_iterations = 1500;     ///< RANSAC's bound: time spent on windows of different places.
  double max_scale_sigma = 0.1;  ///< See RigRelativePoseOptions.
  std::uint64_t seed = 0;
};

/// A match between two views of the two windows.
struct WindowMatch {
  std::size_t query_view = 0;  ///< Position in the query's window.
  std::size_t match_view = 0;  ///< Position in the match's window.
  Match match;                 ///< Of their features.
};

/// How two windows relate.
struct WindowPose {
  Pose match_from_query;  ///< Of the windows' frames, in the odometry's unit. Without scale the translation is a direction.
  /// Whether the two windows' baselines tell the distance between them. They do not when each window is one view, when the
  /// views of a window hover, or when the windows are far apart compared with their lengths.
  bool has_scale = false;
  double scale_sigma = 0;  ///< As RigRelativePose's: of the matches alone. The odometry's own error in its steps comes on top.
  /// Of (translation, rotation), both in the query's axes. A feature that several matches share counts once: the information of
  /// all inliers is scaled by the number of different features over the number of features in all. The windows' own shape counts
  /// as exact: who knows the steps' uncertainty adds it.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<WindowMatch> inliers;
  /// log10 of how many poses with as many inliers one would expect by accident: see evidence.h. This is all that speaks for a
  /// loop here; who accepts it weighs the information too.
  double log10_false_alarms = 0;
  int num_matches = 0;     ///< Of all pairs of views.
  int num_view_pairs = 0;  ///< That share at least min_matches.
  double rms_error_px = 0;
  int num_iterations = 0;
};

/// Relates two windows by the matches between all views of one and all views of the other, as a rig at two places: with the scale
/// from the odometry's baselines within the windows, and without any point triangulated. None when no pose explains seven
/// matches. Throws InputError on an empty window, a missing view or a pose that is not finite.
std::optional<WindowPose> verify_windows(std::span<const WindowView> query, std::span<const WindowView> match,
                                         const WindowOptions& options = {});

}  // namespace fabloop
