// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/map_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "frontend/error.h"
#include "posegraph/run/run_folder.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/tiny_map.h"

namespace fabloop {
namespace {

using testing_support::read_tiny_sequence;
using testing_support::tiny_map_options;

std::size_t count_edges(const PoseGraph& graph, EdgeKind kind) {
  return static_cast<std::size_t>(
      std::count_if(graph.edges.begin(), graph.edges.end(), [kind](const Edge& e) { return e.kind == kind; }));
}

void expect_one_of_each_per_vertex(const Map& map) {
  const std::size_t n = map.graph.vertices.size();
  EXPECT_EQ(map.events.size(), n);
  EXPECT_EQ(map.views.size(), n);
  EXPECT_EQ(map.grey.size(), n);
  EXPECT_EQ(map.final_trajectory.size(), n);
  EXPECT_EQ(map.online_trajectory.size(), n);
  EXPECT_EQ(map.odometry_trajectory.size(), n);
  EXPECT_EQ(map.times.read_s.size(), n);
  EXPECT_EQ(map.times.verify_s.size(), n);
  for (std::size_t v = 0; v < n; ++v) {
    EXPECT_EQ(map.views[v].frame, static_cast<std::size_t>(map.graph.vertices[v].id));
    EXPECT_EQ(map.events[v].query, map.views[v].frame);
    EXPECT_EQ(map.grey[v].size(), map.views[v].features.keypoints.size());
  }
}

TEST(MapSequence, CountsAddUpAndTheErrorFalls) {
  const Sequence sequence = read_tiny_sequence();
  const SequenceMap result = map_sequence(sequence, std::nullopt, tiny_map_options());
  const Map& map = result.map;
  EXPECT_TRUE(result.trained_here.has_value());
  EXPECT_EQ(map.graph.vertices.size(), sequence.frames.size());
  EXPECT_EQ(result.num_damaged, 0U);
  EXPECT_EQ(map.num_without_odometry, 0U);
  expect_one_of_each_per_vertex(map);

  const LoopCounts counts = count_loops(map);
  std::size_t num_links = 0;
  for (const LoopEvent& event : map.events) num_links += event.neighbours.size();
  EXPECT_EQ(count_edges(map.graph, EdgeKind::Odometry), map.graph.vertices.size() - 1);
  EXPECT_EQ(count_edges(map.graph, EdgeKind::Neighbour), num_links);
  EXPECT_EQ(count_edges(map.graph, EdgeKind::Loop), counts.num_accepted);
  EXPECT_GT(counts.num_accepted, 0U);
  EXPECT_LE(counts.num_with_scale, counts.num_accepted);
  EXPECT_LE(counts.num_accepted, counts.num_hypotheses);

  const RunErrors errors = run_errors(sequence, map);
  ASSERT_TRUE(errors.odometry && errors.final);
  EXPECT_LT(errors.final->translation_m.rmse, errors.odometry->translation_m.rmse);
}

TEST(MapSequence, AcceptedLoopsHaveTheirTruePose) {
  // The aerial truth's rule for a right loop: 5 degrees, and a tenth of the height, which is 20 m.
  constexpr double kMaxRotationDeg = 5;
  constexpr double kMaxTranslationM = 2;
  const Sequence sequence = read_tiny_sequence();
  const SequenceMap result = map_sequence(sequence, std::nullopt, tiny_map_options());
  for (const LoopEvent& event : result.map.events) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.verification.verdict != Verdict::Accepted || !outcome.verification.has_scale) continue;
      const Pose truth =
          sequence.frames[outcome.match].world_from_camera->inverse() * *sequence.frames[event.query].world_from_camera;
      const Pose& found = outcome.verification.match_from_query;
      EXPECT_LT(deg_from_rad(found.rotation.angularDistance(truth.rotation)), kMaxRotationDeg)
          << event.query << " " << outcome.match;
      EXPECT_LT((found.translation - truth.translation).norm(), kMaxTranslationM) << event.query << " " << outcome.match;
    }
  }
}

TEST(MapSequence, FramesWithoutOdometryAreLeftOutAndCounted) {
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(8);
  sequence.frames[3].odom_from_camera.reset();
  sequence.frames[4].odom_from_camera.reset();
  const SequenceMap result = map_sequence(sequence, std::nullopt, tiny_map_options());
  EXPECT_EQ(result.map.num_without_odometry, 2U);
  ASSERT_EQ(result.map.graph.vertices.size(), 6U);
  expect_one_of_each_per_vertex(result.map);
  EXPECT_EQ(result.map.graph.vertices[2].id, 2);
  EXPECT_EQ(result.map.graph.vertices[3].id, 5);
  EXPECT_EQ(result.map.final_trajectory[3].time_ns, sequence.frames[5].time_ns);
}

TEST(MapSequence, AnchorsTheMapAtTheFirstPoseOfTheOdometry) {
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(5);
  const Map map = map_sequence(sequence, std::nullopt, tiny_map_options()).map;
  EXPECT_EQ(map.final_trajectory.front().world_from_camera.translation, sequence.frames.front().odom_from_camera->translation);
}

TEST(MapSequence, DamagedImagesAreCounted) {
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(6);
  sequence.frames[2].image_path = "missing.jpg";
  const SequenceMap result = map_sequence(sequence, std::nullopt, tiny_map_options());
  EXPECT_EQ(result.num_damaged, 1U);
  EXPECT_EQ(result.map.graph.vertices.size(), 5U);
}

TEST(MapSequence, AModelIsTakenAsItIs) {
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(5);
  const Model model = map_sequence(sequence, std::nullopt, tiny_map_options()).model;
  MapSequenceOptions options = tiny_map_options();
  options.features.kind = {DetectorKind::Orb, DescriptorKind::Orb};  // which counts only without a model
  const SequenceMap result = map_sequence(sequence, model, options);
  EXPECT_FALSE(result.trained_here.has_value());
  EXPECT_EQ(result.map.views.front().features.descriptor_kind, DescriptorKind::Sift);
  EXPECT_EQ(result.model.vocabulary.num_words(), model.vocabulary.num_words());
}

TEST(MapSequence, OneMappableFrameIsRefused) {
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(3);
  sequence.frames[0].odom_from_camera.reset();
  sequence.frames[2].odom_from_camera.reset();
  const std::string message = test::message_of<InputError>([&] { map_sequence(sequence, std::nullopt, tiny_map_options()); });
  EXPECT_NE(message.find(sequence.name), std::string::npos) << message;
}

TEST(MapSequence, ALaterSessionFindsItsPlacesInTheEarlierMap) {
  const test::ScratchFolder scratch;
  Sequence sequence = read_tiny_sequence();
  sequence.frames.resize(8);
  const Model model = map_sequence(sequence, std::nullopt, tiny_map_options()).model;
  MapSequenceOptions options = tiny_map_options();
  options.mapper.save_map = scratch.path() / "site.map";
  const SequenceMap first = map_sequence(sequence, model, options);
  EXPECT_EQ(read_keyframe_map(options.mapper.save_map, model).keyframes.size(), 8U);

  options.earlier_map = options.mapper.save_map;  // and goes on in it
  const SequenceMap second = map_sequence(sequence, model, options);
  expect_one_of_each_per_vertex(second.map);
  EXPECT_GT(count_loops(second.map).num_into_earlier, 4U) << "the same images again";
  EXPECT_EQ(count_edges(second.map.graph, EdgeKind::Loop),
            count_loops(second.map).num_accepted - count_loops(second.map).num_into_earlier);
  const KeyframeMap both = read_keyframe_map(options.earlier_map, model);
  EXPECT_EQ(both.sessions.size(), 2U);
  EXPECT_EQ(both.keyframes.size(), 16U);
}

TEST(MapSequence, AnEarlierMapNeedsItsModel) {
  MapSequenceOptions options = tiny_map_options();
  options.earlier_map = "site.map";
  const std::string message = test::message_of<InputError>([&] { map_sequence(read_tiny_sequence(), std::nullopt, options); });
  EXPECT_NE(message.find("site.map"), std::string::npos) << message;
  EXPECT_NE(message.find("model"), std::string::npos) << message;
}

TEST(MapSequence, ConfirmedLoopsAreInTheGraphAndOthersAreNot) {
  const Sequence sequence = read_tiny_sequence();
  MapSequenceOptions options = tiny_map_options();
  options.mapper.loops.consistency.num_required = 2;
  const Map map = map_sequence(sequence, std::nullopt, options).map;
  std::size_t num_withdrawn = 0;
  for (const LoopEvent& event : map.events) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      num_withdrawn += outcome.verification.verdict == Verdict::ContradictsMap;
    }
  }
  std::size_t num_handed_out = 0, num_late = 0;
  for (const LoopEvent& event : map.events) {
    num_handed_out += event.loops.size() + event.confirmed.size();
    num_late += event.confirmed.size();
  }
  EXPECT_GT(count_loops(map).num_accepted, 0U);
  EXPECT_EQ(count_edges(map.graph, EdgeKind::Loop), count_loops(map).num_accepted);
  EXPECT_EQ(num_handed_out, count_loops(map).num_accepted + num_withdrawn);
  EXPECT_GT(num_late, 0U) << "the first loops of a revisit come late";
}

}  // namespace
}  // namespace fabloop
