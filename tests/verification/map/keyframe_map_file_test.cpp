// SPDX-License-Identifier: BSD-3-Clause
#include "verification/map/keyframe_map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/error.h"
#include "frontend/fabmap/model_hash.h"
#include "tests/verification/walk_map_file.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using namespace testing_support;

TEST_F(MapFile, GivesBackWhatWasPutKeyframeByKeyframe) {
  const LoopCloser closer = mapped(kNumFrames);
  EXPECT_GT(count_points(closer.map().keyframes[0].view), 0U) << "points that came after the keyframe";
  expect_equal(read_keyframe_map(path_, short_walk().model), closer.map());
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_.path()), {}), 1) << "one file";
}

TEST_F(MapFile, GivesBackAMapThatWasWrittenAtOnce) {
  const LoopCloser closer = mapped(6);
  KeyframeMapFile::create(scratch_.path() / "copy.map", closer.map());
  expect_equal(read_keyframe_map(scratch_.path() / "copy.map", short_walk().model), closer.map());
}

TEST_F(MapFile, KeepsFeaturesOfBitsAndViewsWithoutAny) {
  KeyframeMap map;
  map.model_hash = model_hash(short_walk().model);
  map.sessions.push_back({test_camera(), {}});
  map.sessions[0].camera.distortion = {0.1, -0.2, 0.001, 0.002, 0.3};
  Features bits;
  bits.descriptor_kind = DescriptorKind::Orb;
  bits.pixel_size = 2.5;
  bits.keypoints = {{{1.5F, 2.25F}, 31, 45, 0.5F, 2, -1}};
  bits.descriptors = cv::Mat(1, 32, CV_8U, cv::Scalar(170));
  map.keyframes.resize(2);
  map.keyframes[0].view = make_view(3, map.sessions[0].camera, bits);
  map.keyframes[0].view.height_above_ground = 61.5;
  map.keyframes[0].view.unit_sigma = 0.125;
  map.keyframes[1].view = make_view(4, map.sessions[0].camera, {});
  KeyframeMapFile::create(path_, map);
  const KeyframeMap read = read_keyframe_map(path_, short_walk().model);
  EXPECT_EQ(read.keyframes[1].view.features.keypoints.size(), 0U);
  map.keyframes.pop_back();
  KeyframeMap first = read;
  first.keyframes.pop_back();
  expect_equal(first, map);
}

TEST_F(MapFile, GoesOnWithALaterSession) {
  mapped(5);
  LoopCloser later(test_camera(), short_walk().model, on_body_options(), read_keyframe_map(path_, short_walk().model));
  KeyframeMapFile file = KeyframeMapFile::open(path_, short_walk().model);
  for (std::size_t i = 0; i < 4; ++i) file.put(later.map(), later.add_keyframe(body_frame(i)).changed);
  const KeyframeMap read = read_keyframe_map(path_, short_walk().model);
  EXPECT_EQ(read.sessions.size(), 2U);
  expect_equal(read, later.map());
}

TEST_F(MapFile, RefusesSessionsThatItDoesNotKnow) {
  mapped(3);
  LoopCloser apart(test_camera(), short_walk().model, on_body_options());  // which was not given what the file holds
  const auto changed = apart.add_keyframe(body_frame(0)).changed;
  KeyframeMapFile file = KeyframeMapFile::open(path_, short_walk().model);
  EXPECT_THAT(test::message_of<InputError>([&] { file.put(apart.map(), changed); }), HasSubstr("other sessions"));
  EXPECT_EQ(read_keyframe_map(path_, short_walk().model).keyframes.size(), 3U);
}

TEST_F(MapFile, WritesAllOfAPutOrNothing) {
  LoopCloser closer = mapped(3);
  KeyframeMap map = closer.map();
  map.keyframes.push_back(map.keyframes.back());
  map.keyframes.back().session = 2;  // between which and the file's there is one missing
  map.keyframes.push_back(map.keyframes[2]);
  map.keyframes.back().session = 1;
  map.sessions.resize(3, map.sessions[0]);
  KeyframeMapFile file = KeyframeMapFile::open(path_, short_walk().model);
  EXPECT_THROW(file.put(map, {4, 3, 0}), InputError);
  expect_equal(read_keyframe_map(path_, short_walk().model), closer.map());
}

TEST_F(MapFile, IsNeverReplaced) {
  const LoopCloser closer = mapped(2);
  EXPECT_THAT(test::message_of<InputError>([&] { KeyframeMapFile::create(path_, closer.map()); }),
              HasSubstr("site.map: exists already"));
  expect_equal(read_keyframe_map(path_, short_walk().model), closer.map());
}

TEST_F(MapFile, OfAnotherModelIsRefused) {
  mapped(2);
  Model other = short_walk().model;
  other.vocabulary.words = other.vocabulary.words.clone();
  other.vocabulary.words.at<float>(3, 4) += 1e-3F;
  EXPECT_THAT(message_of_reading(path_, other), HasSubstr("another model"));
  EXPECT_THROW(KeyframeMapFile::open(path_, other), InputError);
  const KeyframeMap map = read_keyframe_map(path_, short_walk().model);
  EXPECT_THROW(LoopCloser(test_camera(), other, on_body_options(), map), InputError);
}

}  // namespace
}  // namespace fabloop
