// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/kept_work.h"

#include <array>
#include <cstdint>
#include <sstream>
#include <utility>

#include "frontend/fabmap/model_hash.h"
#include "frontend/fabmap/model_training.h"
#include "frontend/features/features_bytes.h"

namespace fabloop {
namespace {

void put(StateBytes& bytes, const Segment& segment) {
  std::vector<char> is_placed, has_point;
  for (const auto& pose : segment.world_from_cameras) is_placed.push_back(pose ? 1 : 0);
  for (const auto& point : segment.points) has_point.push_back(point ? 1 : 0);
  bytes.put(is_placed);
  bytes.put(has_point);
  for (const auto& pose : segment.world_from_cameras) {
    if (pose) bytes.put(*pose);
  }
  for (const auto& point : segment.points) {
    if (!point) continue;
    for (const double value : point->x_in_world) bytes.put(value);
    bytes.put(point->seen_by);
  }
}

Segment take_segment(StateBytes& bytes) {
  std::vector<char> is_placed, has_point;
  bytes.take(is_placed);
  bytes.take(has_point);
  Segment segment;
  segment.world_from_cameras.resize(is_placed.size());
  segment.points.resize(has_point.size());
  for (std::size_t i = 0; i < is_placed.size(); ++i) {
    if (is_placed[i] != 0) bytes.take(segment.world_from_cameras[i].emplace());
  }
  for (std::size_t i = 0; i < has_point.size(); ++i) {
    if (has_point[i] == 0) continue;
    SegmentPoint& point = segment.points[i].emplace();
    for (double& value : point.x_in_world) bytes.take(value);
    bytes.take(point.seen_by);
  }
  return segment;
}

void put(StateBytes& bytes, const ViewPair& pair) {
  for (const std::size_t number : {pair.query, pair.match, pair.num_matches}) bytes.put(static_cast<std::uint64_t>(number));
  bytes.put(pair.inliers);
  bytes.put(pair.match_from_query);
  for (const double value : {pair.median_parallax_deg, pair.rotation_share, pair.planar_ratio}) bytes.put(value);
  bytes.put(pair.has_rival);
}

ViewPair take_pair(StateBytes& bytes) {
  ViewPair pair;
  for (std::size_t* number : {&pair.query, &pair.match, &pair.num_matches}) bytes.take(*number);
  bytes.take(pair.inliers);
  bytes.take(pair.match_from_query);
  for (double* value : {&pair.median_parallax_deg, &pair.rotation_share, &pair.planar_ratio}) bytes.take(*value);
  bytes.take(pair.has_rival);
  return pair;
}

std::size_t take_count(StateBytes& bytes) {
  std::uint64_t count = 0;
  bytes.take(count);
  return count;
}

void name_camera(std::ostream& text, const Camera& camera) {
  text << "camera " << camera.width << ' ' << camera.height << ' ' << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' '
       << camera.cy << " lens " << static_cast<int>(camera.distortion_model);
  for (const double k : camera.distortion) text << ' ' << k;
  text << '\n';
}

void name_pair_options(std::ostream& text, const ReconstructOptions& options) {
  const CandidatePairsOptions& c = options.candidates;
  text << "candidates: neighbours " << c.num_neighbours << ", hypotheses " << c.num_hypotheses << ", nearest " << c.num_nearest
       << ", training features " << c.num_training_features << '\n';
  if (c.num_nearest > 0) {
    for (const auto& position : options.known_positions) {
      text << "position";
      if (position) text << ' ' << position->transpose();
      text << '\n';
    }
  }
  const ViewGraphOptions& v = options.view_graph;
  text << "pairs: ratio " << v.matching.max_ratio << ", spot " << v.matching.same_spot_px << ", search "
       << static_cast<int>(v.matching.search) << ", first " << v.num_first_features << ' ' << v.min_first_group << ", inliers "
       << v.min_inliers << ", error " << v.max_error_px << ", false alarms " << v.max_log10_false_alarms << ", iterations "
       << v.max_iterations << '\n';
}

void name_growth_options(std::ostream& text, const GrowthOptions& g) {
  const TwoViewStartOptions& s = g.start;
  text << "start: parallax " << s.good_parallax_deg << ' ' << s.min_parallax_deg << ' ' << s.triangulation.min_parallax_deg
       << ", rotation " << s.max_rotation_share << ", points " << s.min_points << ", error " << s.triangulation.max_error_px
       << '\n';
  const LocalAdjustmentOptions& l = g.local;
  text << "growth: resection " << g.resection.max_error_px << ' ' << g.resection.min_inliers << ' '
       << g.resection.min_inlier_share << ' ' << g.resection.max_iterations << ", triangulation "
       << g.triangulation.min_parallax_deg << ' ' << g.triangulation.max_error_px << ", local " << l.bundle.loss_px << ' '
       << l.bundle.max_iterations << ' ' << l.bundle.cost_tolerance << ' ' << l.num_neighbours << ' '
       << l.num_points_per_neighbour << ", whole " << g.growth_per_adjustment << ' ' << g.num_points_per_view << ", views "
       << g.min_views << ", starts " << g.num_starts << ' ' << g.min_start_agreement << '\n';
}

/// Tells where a former run stopped, if it had begun.
void tell_resumption(const WorkState& state, std::size_t num_frames, const Warn& warn) {
  if (!warn || !state.keeps()) return;
  std::size_t num_described = 0;
  for (std::size_t frame = 0; frame < num_frames; ++frame) num_described += state.has(numbered_name(kKeptView, frame));
  if (num_described == 0) return;
  const char* stage = state.has(kKeptSegments) ? "placing" : state.has(kKeptCandidates) ? "pairs" : "features";
  warn("resuming at " + std::string(stage) + " of " + state.folder().string() + ": " + std::to_string(num_described) + " of " +
       std::to_string(num_frames) + " images need not be read again");
}

}  // namespace

StateBytes bytes_of(const ColourView& view) {
  StateBytes bytes;
  put(bytes, view.view.features);
  std::vector<std::array<std::uint8_t, 3>> colours;
  for (const cv::Vec3b& colour : view.red_green_blue) colours.push_back({colour[0], colour[1], colour[2]});
  bytes.put(colours);
  return bytes;
}

ColourView take_colour_view(StateBytes& bytes, std::size_t frame, const Camera& camera) {
  ColourView view;
  view.view = make_view(frame, camera, take_features(bytes));
  std::vector<std::array<std::uint8_t, 3>> colours;
  bytes.take(colours);
  if (colours.size() != view.view.features.keypoints.size()) throw StateDamaged();
  for (const auto& colour : colours) view.red_green_blue.emplace_back(colour[0], colour[1], colour[2]);
  return view;
}

void keep_frames(const std::vector<View>& views, WorkState& state) {
  std::vector<std::uint64_t> frames;
  for (const View& view : views) frames.push_back(view.frame);
  const auto take_frames = [](StateBytes& bytes) {
    std::vector<std::uint64_t> kept;
    bytes.take(kept);
    return kept;
  };
  if (state.read_as(kKeptFrames, take_frames) == frames) return;
  state.remove_all_but(kKeptView);
  StateBytes bytes;
  bytes.put(frames);
  state.write(kKeptFrames, bytes);
}

StateBytes bytes_of(const std::vector<CandidatePair>& candidates) {
  StateBytes bytes;
  bytes.put(candidates);
  return bytes;
}

std::vector<CandidatePair> take_candidates(StateBytes& bytes) {
  std::vector<CandidatePair> candidates;
  bytes.take(candidates);
  return candidates;
}

StateBytes bytes_of(const std::vector<std::optional<ViewPair>>& pairs) {
  StateBytes bytes;
  bytes.put(static_cast<std::uint64_t>(pairs.size()));
  for (const auto& pair : pairs) {
    bytes.put(pair.has_value());
    if (pair) put(bytes, *pair);
  }
  return bytes;
}

std::vector<std::optional<ViewPair>> take_pairs(StateBytes& bytes) {
  std::vector<std::optional<ViewPair>> pairs;
  for (std::size_t left = take_count(bytes); left > 0; --left) {
    bool is_proven = false;
    bytes.take(is_proven);
    pairs.push_back(is_proven ? std::optional(take_pair(bytes)) : std::nullopt);
  }
  return pairs;
}

StateBytes bytes_of(const SegmentsSoFar& segments) {
  StateBytes bytes;
  bytes.put(static_cast<std::uint64_t>(segments.num_starts_tried));
  bytes.put(segments.is_last_growing);
  bytes.put(static_cast<std::uint64_t>(segments.segments.size()));
  for (const Segment& segment : segments.segments) put(bytes, segment);
  return bytes;
}

SegmentsSoFar take_segments(StateBytes& bytes) {
  SegmentsSoFar segments;
  segments.num_starts_tried = take_count(bytes);
  bytes.take(segments.is_last_growing);
  for (std::size_t left = take_count(bytes); left > 0; --left) segments.segments.push_back(take_segment(bytes));
  return segments;
}

std::string inputs_text(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options) {
  std::ostringstream text;
  text.precision(17);
  text << features_text(model ? model->features : options.features);
  text << "model " << (model ? model_hash(*model) : "of the sequence itself") << '\n';
  name_camera(text, sequence.camera);
  name_pair_options(text, options);
  name_growth_options(text, options.growth);
  text << "seed " << options.seed << "\nimages " << sequence.frames.size() << '\n';
  for (const Frame& frame : sequence.frames) text << file_identity(frame.image_path);
  return text.str();
}

WorkState open_state(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options) {
  if (options.state_folder.empty()) return {};
  WorkState state(options.state_folder, "map", inputs_text(sequence, model, options), options.if_state_found, options.warn);
  tell_resumption(state, sequence.frames.size(), options.warn);
  return state;
}

}  // namespace fabloop
