// SPDX-License-Identifier: BSD-3-Clause
#include "verification/keyframe_map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "frontend/fabmap/model_hash.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"
#include "verification/loop_closer.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::Walk;

constexpr std::size_t kNumFrames = 12;  // mapped here

const Walk& short_walk() {
  static const Walk walk = make_walk({.num_landmarks = 3000, .num_frames = 36, .num_again = 0});
  return walk;
}

LoopCloserOptions options() {
  LoopCloserOptions result;
  result.hypotheses.max_hypotheses = 1;
  result.num_threads = 1;
  result.body_from_camera = {rotation_from_vector({0.1, 0.2, 0.3}), {1, 2, 3}};
  return result;
}

Keyframe frame(std::size_t i) {
  Keyframe keyframe = keyframe_of(short_walk(), i);
  keyframe.odom_from_body = keyframe.odom_from_body * options().body_from_camera.inverse();
  if (i % 2 == 1) keyframe.step_covariance = 0.01 * static_cast<double>(i) * Eigen::Matrix<double, 6, 6>::Identity();
  return keyframe;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void expect_equal(const View& a, const View& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.features.descriptor_kind, b.features.descriptor_kind);
  ASSERT_EQ(a.features.keypoints.size(), b.features.keypoints.size());
  for (std::size_t i = 0; i < a.features.keypoints.size(); ++i) {
    const cv::KeyPoint &k = a.features.keypoints[i], &l = b.features.keypoints[i];
    EXPECT_TRUE(k.pt == l.pt && k.size == l.size && k.angle == l.angle && k.response == l.response && k.octave == l.octave &&
                k.class_id == l.class_id);
    EXPECT_EQ(a.rays[i], b.rays[i]);
    EXPECT_EQ(a.points_in_camera[i], b.points_in_camera[i]);
    EXPECT_EQ(a.point_weights[i], b.point_weights[i]);
  }
  EXPECT_EQ(a.features.descriptors.type(), b.features.descriptors.type());
  EXPECT_EQ(cv::norm(a.features.descriptors, b.features.descriptors, cv::NORM_INF), 0.0);
}

void expect_equal(const KeyframeMap& a, const KeyframeMap& b) {
  EXPECT_EQ(a.model_hash, b.model_hash);
  ASSERT_EQ(a.sessions.size(), b.sessions.size());
  for (std::size_t i = 0; i < a.sessions.size(); ++i) {
    EXPECT_EQ(a.sessions[i].camera.cx, b.sessions[i].camera.cx);
    EXPECT_EQ(a.sessions[i].camera.distortion, b.sessions[i].camera.distortion);
    EXPECT_EQ(a.sessions[i].body_from_camera.translation, b.sessions[i].body_from_camera.translation);
    EXPECT_EQ(a.sessions[i].body_from_camera.rotation.coeffs(), b.sessions[i].body_from_camera.rotation.coeffs());
  }
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const MapKeyframe &k = a.keyframes[i], &l = b.keyframes[i];
    EXPECT_EQ(k.session, l.session);
    EXPECT_EQ(k.time_ns, l.time_ns);
    EXPECT_EQ(k.odom_from_body.translation, l.odom_from_body.translation);
    EXPECT_EQ(k.odom_from_body.rotation.coeffs(), l.odom_from_body.rotation.coeffs());
    EXPECT_EQ(k.step_covariance, l.step_covariance);
    EXPECT_EQ(k.words.words, l.words.words);
    expect_equal(k.view, l.view);
  }
}

class MapFile : public testing::Test {
 protected:
  /// The first `num_frames` of the walk, each written as it came.
  LoopCloser mapped(std::size_t num_frames) {
    LoopCloser closer(test_camera(), short_walk().model, options());
    KeyframeMapFile file = KeyframeMapFile::create(path_, closer.map());
    for (std::size_t i = 0; i < num_frames; ++i) file.put(closer.map(), closer.add_keyframe(frame(i)).changed);
    return closer;
  }
  /// Puts keyframe by keyframe, with a byte before each.
  [[noreturn]] void write_until_killed(KeyframeMap map, const std::vector<std::vector<std::size_t>>& changed, int bytes) {
    try {
      KeyframeMap without_keyframes = map;
      without_keyframes.keyframes.clear();
      KeyframeMapFile file = KeyframeMapFile::create(path_, without_keyframes);
      for (const auto& places : changed) {
        if (write(bytes, "x", 1) != 1) _exit(1);
        file.put(map, places);
      }
      while (true) pause();
    } catch (...) {
      _exit(1);
    }
  }
  std::string message_of_reading(const fs::path& path, const Model& model = short_walk().model) {
    return test::message_of<InputError>([&] { read_keyframe_map(path, model); });
  }

  test::ScratchFolder scratch_;
  fs::path path_ = scratch_.path() / "site.map";
};

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
  bits.keypoints = {{{1.5F, 2.25F}, 31, 45, 0.5F, 2, -1}};
  bits.descriptors = cv::Mat(1, 32, CV_8U, cv::Scalar(170));
  map.keyframes.resize(2);
  map.keyframes[0].view = make_view(3, map.sessions[0].camera, bits);
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
  LoopCloser later(test_camera(), short_walk().model, options(), read_keyframe_map(path_, short_walk().model));
  KeyframeMapFile file = KeyframeMapFile::open(path_, short_walk().model);
  for (std::size_t i = 0; i < 4; ++i) file.put(later.map(), later.add_keyframe(frame(i)).changed);
  const KeyframeMap read = read_keyframe_map(path_, short_walk().model);
  EXPECT_EQ(read.sessions.size(), 2U);
  expect_equal(read, later.map());
}

TEST_F(MapFile, RefusesSessionsThatItDoesNotKnow) {
  mapped(3);
  LoopCloser apart(test_camera(), short_walk().model, options());  // which was not given what the file holds
  const auto changed = apart.add_keyframe(frame(0)).changed;
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
  EXPECT_THROW(LoopCloser(test_camera(), other, options(), map), InputError);
}

TEST_F(MapFile, ThatIsNoneIsNamed) {
  EXPECT_THAT(message_of_reading(path_), HasSubstr("site.map: there is no such"));
  EXPECT_THAT(message_of_reading(scratch_.write("empty.map", "")), HasSubstr("is not a keyframe map"));
  EXPECT_THAT(message_of_reading(scratch_.write("text.map", std::string(10000, 'x'))), HasSubstr("is not a keyframe map"));
  EXPECT_THAT(message_of_reading(scratch_.path()), HasSubstr("no such"));
  EXPECT_THROW(KeyframeMapFile::create(scratch_.path() / "missing" / "site.map", {}), InputError);
}

TEST_F(MapFile, OfAnotherVersionIsRefused) {
  mapped(1);
  std::string bytes = text_of(path_);
  bytes[63] = 9;  // the last byte of user_version in the head of SQLite's file format
  EXPECT_THAT(message_of_reading(scratch_.write("later.map", bytes)), HasSubstr("format 9"));
}

TEST_F(MapFile, DamageIsFoundWhereverItIs) {
  const LoopCloser closer = mapped(10);
  const std::string sound = text_of(path_);
  constexpr std::size_t kTrials = 40;
  std::size_t num_found = 0;
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    std::string bytes = sound;
    bytes[(2 * trial + 1) * sound.size() / (2 * kTrials)] ^= 0x10;
    const fs::path path = scratch_.write("damaged.map", bytes);
    try {
      // Bytes that no row uses may change; what is read is then the same.
      expect_equal(read_keyframe_map(path, short_walk().model), closer.map());
    } catch (const InputError& error) {
      ++num_found;
      EXPECT_THAT(error.what(), HasSubstr("damaged.map"));
    }
  }
  EXPECT_GT(num_found, kTrials / 2) << "most of the file is in use";
}

TEST_F(MapFile, ATruncatedFileIsRefused) {
  mapped(3);
  const std::string sound = text_of(path_);
  for (const double share : {0.02, 0.3, 0.7, 0.95}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(sound.size()));
    message_of_reading(scratch_.write("short.map", sound.substr(0, size)));
  }
}

TEST_F(MapFile, LosesNothingWhenItsWriterIsKilled) {
  LoopCloser closer(test_camera(), short_walk().model, options());
  std::vector<std::vector<std::size_t>> changed;
  for (std::size_t i = 0; i < kNumFrames; ++i) changed.push_back(closer.add_keyframe(frame(i)).changed);
  for (const std::size_t num_acknowledged : {0U, 1U, 4U, 9U}) {
    fs::remove(path_);
    int acknowledgements[2];
    ASSERT_EQ(pipe(acknowledgements), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_until_killed(closer.map(), changed, acknowledgements[1]);
    std::string read_so_far(num_acknowledged + 1, ' ');
    for (char& byte : read_so_far) ASSERT_EQ(read(acknowledgements[0], &byte, 1), 1);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(acknowledgements[0]);
    close(acknowledgements[1]);
    const KeyframeMap map = read_keyframe_map(path_, short_walk().model);
    EXPECT_GE(map.keyframes.size(), num_acknowledged);
    KeyframeMap written = closer.map();
    written.keyframes.resize(map.keyframes.size());
    expect_equal(map, written);
  }
}

}  // namespace
}  // namespace fabloop
