// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "tests/verification/walk_map_file.h"
#include "verification/map/keyframe_map_file.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using namespace testing_support;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Puts keyframe by keyframe, with a byte before each.
[[noreturn]] void write_until_killed(const fs::path& path, const KeyframeMap& map,
                                     const std::vector<std::vector<std::size_t>>& changed, int bytes) {
  try {
    KeyframeMap without_keyframes = map;
    without_keyframes.keyframes.clear();
    KeyframeMapFile file = KeyframeMapFile::create(path, without_keyframes);
    for (const auto& places : changed) {
      if (write(bytes, "x", 1) != 1) _exit(1);
      file.put(map, places);
    }
    while (true) pause();
  } catch (...) {
    _exit(1);
  }
}

class DamagedMap : public MapFile {};

TEST_F(DamagedMap, ThatIsNoneIsNamed) {
  EXPECT_THAT(message_of_reading(path_), HasSubstr("site.map: there is no such"));
  EXPECT_THAT(message_of_reading(scratch_.write("empty.map", "")), HasSubstr("is not a keyframe map"));
  EXPECT_THAT(message_of_reading(scratch_.write("text.map", std::string(10000, 'x'))), HasSubstr("is not a keyframe map"));
  EXPECT_THAT(message_of_reading(scratch_.path()), HasSubstr("no such"));
  EXPECT_THROW(KeyframeMapFile::create(scratch_.path() / "missing" / "site.map", {}), InputError);
}

TEST_F(DamagedMap, OfAnotherVersionIsRefused) {
  mapped(1);
  std::string bytes = text_of(path_);
  bytes[63] = 9;  // the last byte of user_version in the head of SQLite's file format
  EXPECT_THAT(message_of_reading(scratch_.write("later.map", bytes)), HasSubstr("format 9"));
}

TEST_F(DamagedMap, DamageIsFoundWhereverItIs) {
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

TEST_F(DamagedMap, ATruncatedFileIsRefused) {
  mapped(3);
  const std::string sound = text_of(path_);
  for (const double share : {0.02, 0.3, 0.7, 0.95}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(sound.size()));
    message_of_reading(scratch_.write("short.map", sound.substr(0, size)));
  }
}

TEST_F(DamagedMap, LosesNothingWhenItsWriterIsKilled) {
  LoopCloser closer(test_camera(), short_walk().model, on_body_options());
  std::vector<std::vector<std::size_t>> changed;
  for (std::size_t i = 0; i < kNumFrames; ++i) changed.push_back(closer.add_keyframe(body_frame(i)).changed);
  for (const std::size_t num_acknowledged : {0U, 1U, 4U, 9U}) {
    fs::remove(path_);
    int acknowledgements[2];
    ASSERT_EQ(pipe(acknowledgements), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_until_killed(path_, closer.map(), changed, acknowledgements[1]);
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
