// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/sfm/reconstruct.h"
#include "posegraph/sfm/reconstruction_folder.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kNumFrames = 10;  // more would only take longer

/// What a kill is to the library: something that is no InputError stops it where it is.
struct Killed {};

std::string bytes_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ReconstructResume : public ::testing::Test {
 protected:
  ReconstructResume() {
    sequence_ = read_sequence(testing_support::tiny_sequence());
    sequence_.frames.resize(kNumFrames);
    options_.features.max_features = 300;
    options_.candidates.num_training_features = 100;
    options_.candidates.num_neighbours = 3;
    options_.candidates.num_hypotheses = 3;
    options_.num_threads = 2;
    options_.state_folder = folder_.path() / "run.part";
    options_.warn = [this](const std::string& message) { warnings_.push_back(message); };
  }

  /// Reconstructs until the progress of a stage has been told so many times, and is killed there. False when it came to its end.
  bool run_and_kill(const std::string& stage, int reports) {
    warnings_.clear();
    ReconstructOptions options = options_;
    options.progress = [&, left = reports](std::string_view now, std::size_t, std::size_t) mutable {
      if (now == stage && --left == 0) throw Killed();
    };
    try {
      reconstruct(sequence_, std::nullopt, options);
    } catch (const Killed&) {
      return true;
    }
    return false;
  }

  Reconstructed run(ReconstructOptions options) {
    warnings_.clear();
    num_placing_reports_ = 0;
    options.progress = [&](std::string_view stage, std::size_t, std::size_t) { num_placing_reports_ += stage == "placing"; };
    return reconstruct(sequence_, std::nullopt, options);
  }

  ReconstructOptions without_state() const {
    ReconstructOptions options = options_;
    options.state_folder.clear();
    return options;
  }

  /// All poses, points and sightings, to the last bit.
  std::string bytes_of_model(const Reconstructed& result, const std::string& name) {
    const fs::path path = folder_.path() / name;
    write_reconstruction_folder(path, sequence_, result, without_state());
    return bytes_of_file(path / "trajectory.tum") + bytes_of_file(path / "points.ply") + bytes_of_file(path / "graph.g2o") +
           bytes_of_file(path / "colmap" / "images.txt") + bytes_of_file(path / "colmap" / "points3D.txt");
  }

  test::ScratchFolder folder_;
  Sequence sequence_;
  ReconstructOptions options_;
  std::vector<std::string> warnings_;
  int num_placing_reports_ = 0;
};

TEST_F(ReconstructResume, GivesTheSameMapWhereverItWasKilled) {
  const Reconstructed uninterrupted = run(without_state());
  const int num_placing_reports = num_placing_reports_;
  ASSERT_EQ(uninterrupted.reconstruction.images.size(), kNumFrames);
  ASSERT_TRUE(run_and_kill("features", 4));
  EXPECT_THAT(warnings_, IsEmpty());
  ASSERT_TRUE(run_and_kill("pairs", 34));  // one block of 32 is complete at the latest when two threads have done so many
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("resuming at features of")));
  ASSERT_TRUE(run_and_kill("placing", 4));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("resuming at pairs of " + options_.state_folder.string() +
                                               ": 10 of 10 images need not be read again")));
  ASSERT_TRUE(run_and_kill("placing", 2));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("resuming at placing of")));
  const Reconstructed resumed = run(options_);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("resuming at placing of")));
  EXPECT_LT(num_placing_reports_, num_placing_reports);
  EXPECT_TRUE(bytes_of_model(resumed, "resumed") == bytes_of_model(uninterrupted, "uninterrupted"));
  EXPECT_EQ(resumed.pairs.size(), uninterrupted.pairs.size());
}

TEST_F(ReconstructResume, StartsAnewOnOtherOptionsOrImagesAndSaysSo) {
  ASSERT_TRUE(run_and_kill("features", 3));
  options_.candidates.num_hypotheses = 4;
  ASSERT_TRUE(run_and_kill("features", 1));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("with other options (now: candidates: neighbours 3, hypotheses 4")));
  sequence_.frames.pop_back();
  ASSERT_TRUE(run_and_kill("features", 1));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("now: images 9")));
  sequence_.camera.fx += 1.0;
  ASSERT_TRUE(run_and_kill("features", 1));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("now: camera ")));
  options_.if_state_found = WorkState::IfFound::Discard;
  ASSERT_TRUE(run_and_kill("features", 1));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(ReconstructResume, NoOtherRunRemovesKeptWork) {
  ASSERT_TRUE(run_and_kill("features", 3));
  EXPECT_THROW(OutputFolder{folder_.path() / "run"}, InputError);
  EXPECT_TRUE(fs::exists(options_.state_folder / "inputs.txt"));
}

TEST_F(ReconstructResume, DoesDamagedWorkAgain) {
  ASSERT_TRUE(run_and_kill("pairs", 1));
  fs::resize_file(options_.state_folder / "view-00002", 100);
  fs::resize_file(options_.state_folder / "candidates", 20);
  ASSERT_TRUE(run_and_kill("pairs", 1));
  EXPECT_THAT(warnings_, Contains(HasSubstr("view-00002 is damaged")));
  EXPECT_THAT(warnings_, Contains(HasSubstr("candidates is damaged")));
}

TEST_F(ReconstructResume, KeepsNoPairsOfOtherViews) {
  testing_support::copy_tiny_sequence(folder_.path() / "flight", kNumFrames);
  sequence_ = read_sequence(folder_.path() / "flight");
  const Reconstructed uninterrupted = run(without_state());
  const fs::path image = sequence_.frames[2].image_path;
  const std::string bytes = bytes_of_file(image);
  const auto time = fs::last_write_time(image);
  const auto write = [&](const std::string& content) {
    std::ofstream(image, std::ios::binary) << content;
    fs::last_write_time(image, time);
  };
  options_.if_damaged = IfDamaged::Skip;
  write(std::string(bytes.size(), '\0'));  // a disk that cannot be read for a while
  ASSERT_TRUE(run_and_kill("placing", 1));
  EXPECT_TRUE(fs::exists(options_.state_folder / "pairs-00000"));
  write(bytes);
  const Reconstructed resumed = run(options_);
  EXPECT_TRUE(bytes_of_model(resumed, "resumed") == bytes_of_model(uninterrupted, "uninterrupted"));
}

TEST_F(ReconstructResume, ForgetsWhatIsNoStateOnlyWhenToldTo) {
  fs::create_directories(options_.state_folder);
  std::ofstream(options_.state_folder / "trajectory.tum") << "left by another run\n";
  EXPECT_THROW(reconstruct(sequence_, std::nullopt, options_), InputError);
  EXPECT_TRUE(fs::exists(options_.state_folder / "trajectory.tum"));
  options_.if_state_found = WorkState::IfFound::Discard;
  ASSERT_TRUE(run_and_kill("features", 1));
  EXPECT_FALSE(fs::exists(options_.state_folder / "trajectory.tum"));
}

TEST_F(ReconstructResume, LeavesNoStateOfBadInput) {
  sequence_.frames = {sequence_.frames[0], sequence_.frames[9]};
  EXPECT_THROW(reconstruct(sequence_, std::nullopt, options_), InputError);
  EXPECT_FALSE(fs::exists(options_.state_folder));
}

TEST_F(ReconstructResume, GivesUpTheStateWhenTheFolderIsWritten) {
  sequence_.frames.resize(5);
  const Reconstructed result = reconstruct(sequence_, std::nullopt, options_);
  EXPECT_TRUE(fs::exists(options_.state_folder / "segments"));
  write_reconstruction_folder(folder_.path() / "run", sequence_, result, options_);
  EXPECT_TRUE(fs::exists(folder_.path() / "run" / "summary.json"));
  EXPECT_FALSE(fs::exists(options_.state_folder));
}

}  // namespace
}  // namespace fabloop
