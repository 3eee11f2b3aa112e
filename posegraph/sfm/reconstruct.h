// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"
#include "frontend/work_state.h"
#include "posegraph/sfm/bundle_adjustment.h"
#include "posegraph/sfm/camera_check.h"
#include "posegraph/sfm/candidate_pairs.h"
#include "posegraph/sfm/colour_views.h"
#include "posegraph/sfm/georeference.h"
#include "posegraph/sfm/gps.h"
#include "posegraph/sfm/growth.h"
#include "posegraph/sfm/reconstruction.h"
#include "posegraph/sfm/rolling_shutter.h"
#include "posegraph/sfm/segments.h"
#include "posegraph/sfm/view_graph.h"

namespace fabloop {

/// Features as structure from motion wants them: more than recognition does, for tracks through many views.
FeatureOptions reconstruction_features();

/// A map from images alone while it is made.
struct PlacedSoFar {
  std::string_view stage;              ///< "placing", then the names of the later stages (see StageTime), "result" in the end.
  const std::vector<View>& views;      ///< All of the scene.
  const std::vector<ViewPair>& pairs;  ///< Proven by two views; positions in `views`.
  const Segment& segment;              ///< The one that grows, which need not be the largest.
  LengthUnit unit = LengthUnit::Arbitrary;  ///< Of its positions.
};

/// Called after each view that was placed and when a later stage begins, from the thread that makes the map.
using WatchPlaced = std::function<void(const PlacedSoFar&)>;

struct ReconstructOptions {
  FeatureOptions features = reconstruction_features();  ///< Only without a model; a model brings its own.
  IfDamaged if_damaged = IfDamaged::Skip;
  CandidatePairsOptions candidates;
  ViewGraphOptions view_graph;
  GrowthOptions growth;
  JoinOptions join;
  /// A calibration is kept unless asked otherwise; what is asked is done only where the images determine the focal length.
  RefineCamera refine = RefineCamera::Nothing;
  CameraCheckOptions camera_check;
  RollingShutterOptions rolling_shutter;  ///< Of the finished map; segments grow as under a global shutter.
  /// Positions of the frames (one a frame, where known): GPS in an east-north-up frame, or an odometry's. Empty: none.
  std::vector<std::optional<Eigen::Vector3d>> known_positions{};
  std::optional<GeoPosition> origin{};  ///< Of the positions, where they are on Earth.
  PositionUse position_use = PositionUse::Witness;
  GeoreferenceOptions georeference;
  double max_error_px = 3.0;  ///< Of a sighting in the result; pixels of the images as their features were found.
  /// Reconstruct from the pairs of neighbours alone, too: shows what the loops are worth, and takes up to half as long again.
  bool also_without_loops = false;
  std::uint64_t seed = 1;  ///< Of training, RANSAC and sampling.
  int num_threads = 0;     ///< 0: all. The result does not depend on it.
  /// Folder in which finished work is kept, so that the same reconstruction, killed at any moment, goes on from there to the same
  /// result: see WorkState. It stays until its owner removes it. Empty: nothing is kept.
  std::filesystem::path state_folder{};
  WorkState::IfFound if_state_found = WorkState::IfFound::Resume;
  Warn warn;
  Progress progress;
  WatchPlaced watch{};  ///< For those who show the map while it grows. The result does not depend on it.
};

/// A frame without a place, and why.
struct LeftOutFrame {
  std::size_t frame = 0;
  std::string why;
};

/// A stage and its seconds.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// A pair of frames whose matches are proven.
struct FramePair {
  std::size_t query = 0, match = 0;  ///< Positions in the sequence.
  std::size_t num_matches = 0;
  std::size_t num_inliers = 0;
  double median_parallax_deg = 0;
};

/// A reconstruction and how it came about.
struct Reconstructed {
  Reconstruction reconstruction;
  std::vector<LeftOutFrame> left_out;
  /// Frames of the parts that could not be joined with the largest, each in a world of its own.
  std::vector<std::vector<std::size_t>> other_parts;
  std::vector<FramePair> pairs;  ///< In ascending order.
  std::size_t num_candidate_pairs = 0;
  std::size_t num_merged_points = 0;  ///< Points that turned out to be another one.
  double mean_error_px = 0;           ///< Of all sightings; pixels of the images, shrunk or not.
  double feature_pixel_size = 1;      ///< Side of a pixel of the images in which features were found, in pixels of the images.
  std::size_t num_sightings = 0;
  CameraCheck camera_check;
  bool camera_was_refined = false;
  RollingShutterCheck rolling_shutter_check;        ///< Beside what the map was made with.
  std::optional<ModelledReadout> modelled_readout;  ///< Of the rolling shutter that the map was made with.
  GeoreferenceResult georeference;                  ///< Before positions were let into the adjustment.
  /// The largest part that pairs of neighbours alone give, laid onto the result by a similarity; empty unless it was asked for.
  Trajectory odometry;
  std::vector<StageTime> times;
};

/// Structure from motion over a sequence's images: features once an image, pairs that FAB-MAP proposes and geometry proves,
/// tracks, segments that grow view by view (Schoenberger & Frahm, CVPR 2016), joined over shared points, bundle adjustment of
/// all. The largest part is the result; what it leaves out is named with the reason. Throws InputError when no two views can be
/// placed; what was kept of that is removed, since images or options must change.
Reconstructed reconstruct(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options = {});

}  // namespace fabloop
