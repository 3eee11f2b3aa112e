// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_cell.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <set>

#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

LabDescription two_sweeps() {
  LabDescription lab;
  lab.synthetic.emplace();
  lab.seeds = {1, 2, 3};
  lab.sweep = {{lab_parameter("aliasing"), {0.0, 0.5}}, {lab_parameter("blurred_frames"), {0.1, 0.2}}};
  lab.methods = {{"fabmap", PlaceMethod::FabMap, ""}};
  lab.stages = {Stage::Appearance};
  return lab;
}

TEST(LabCell, EveryCombinationIsACellAndSeedsAreInnermost) {
  const std::vector<LabCell> cells = cells_of(two_sweeps(), {});
  ASSERT_EQ(cells.size(), 12u);
  EXPECT_EQ(cells[0].group(), "synthetic, aliasing 0, blurred_frames 0.1");
  EXPECT_EQ(cells[2].group(), cells[0].group());
  EXPECT_EQ(cells[2].seed, 3u);
  EXPECT_EQ(cells[2].settings.trouble.seed, 3u) << "troubles are drawn anew as well";
  EXPECT_EQ(cells[11].group(), "synthetic, aliasing 0.5, blurred_frames 0.2");
  EXPECT_EQ(cells[11].settings.aliasing, 0.5);
  EXPECT_EQ(cells[11].settings.trouble.blurred_frames, 0.2);
}

TEST(LabCell, ItsChecksumChangesWithAllThatItsResultDependsOn) {
  const LabDescription lab = two_sweeps();
  const std::vector<LabCell> cells = cells_of(lab, {});
  std::set<std::string> checksums;
  for (const LabCell& cell : cells) checksums.insert(cell_checksum(cell, lab));
  LabDescription changed = lab;
  changed.synthetic->length_m = 501;
  checksums.insert(cell_checksum(cells[0], changed));
  changed = lab;
  changed.stages = {Stage::Geometry};
  checksums.insert(cell_checksum(cells[0], changed));
  changed = lab;
  changed.features.max_features = 7;
  checksums.insert(cell_checksum(cells[0], changed));
  changed = lab;
  changed.methods = {{"vlad", PlaceMethod::Vlad, ""}};
  checksums.insert(cell_checksum(cells[0], changed));
  EXPECT_EQ(checksums.size(), cells.size() + 4);
  // What is only said of the results does not make them again.
  changed = lab;
  changed.title = "another";
  changed.evaluation.bootstrap.num_resamples = 3;
  EXPECT_EQ(cell_checksum(cells[0], changed), cell_checksum(cells[0], lab));
}

TEST(LabCell, AnEarlierFlightIsAnotherOneAndHasAPartInTheResult) {
  const test::ScratchFolder folder;
  for (const char* name : {"park", "field"}) std::filesystem::create_directory(folder.path() / name);
  folder.write("field/frames.csv", "a,1\n");
  LabDescription lab = two_sweeps();
  lab.synthetic.reset();
  lab.sweep.clear();
  lab.seeds = {1};
  lab.sequences = {{"park", 60.0, ""}, {"park", 60.0, "field/"}};
  const std::vector<LabCell> cells = cells_of(lab, folder.path());
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].group(), "park");
  EXPECT_EQ(cells[1].group(), "park after field");
  const std::string before = cell_checksum(cells[1], lab), alone = cell_checksum(cells[0], lab);
  folder.write("field/frames.csv", "a,2\n");
  EXPECT_NE(cell_checksum(cells[1], lab), before);
  EXPECT_EQ(cell_checksum(cells[0], lab), alone);
  lab.sequences = {{"park", 60.0, "park"}};
  EXPECT_THAT(test::message_of<InputError>([&] { cells_of(lab, folder.path()); }), HasSubstr("cannot come after itself"));
  lab.sequences = {{"park", 60.0, "lake"}};
  EXPECT_THAT(test::message_of<InputError>([&] { cells_of(lab, folder.path()); }), HasSubstr("there is no such sequence"));
}

TEST(LabCell, FilesOfSequencesAndScoresAreAmongThat) {
  const test::ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "flight");
  folder.write("flight/frames.csv", "a,1\n");
  folder.write("flight-2.csv", "query,match,score\n");
  LabDescription lab;
  lab.path = folder.path() / "lab.yaml";
  lab.sequences = {{"flight/", 40}};
  lab.seeds = {2};
  lab.methods = {{"mine", std::nullopt, "{data}-{seed}.csv"}};
  lab.stages = {Stage::Appearance};
  const LabCell cell = cells_of(lab, folder.path()).front();
  EXPECT_EQ(cell.data, "flight");
  EXPECT_EQ(cell.height_above_ground_m, 40);
  EXPECT_EQ(scores_file(lab.methods[0], cell, lab), folder.path() / "flight-2.csv");
  LabMethod swept = lab.methods[0];
  swept.scores = "{dropped_frames}/{top}.csv";
  LabCell troubled = cell;
  troubled.settings.trouble.dropped_frames = 0.3;
  EXPECT_EQ(scores_file(swept, troubled, lab), folder.path() / "0.3" / "10.csv");
  const std::string before = cell_checksum(cell, lab);
  EXPECT_EQ(cell_checksum(cell, lab), before);
  folder.write("flight-2.csv", "query,match,score\n9,1,0.5\n");
  const std::string with_score = cell_checksum(cell, lab);
  EXPECT_NE(with_score, before);
  folder.write("flight/frames.csv", "a,1\nb,2\n");
  EXPECT_NE(cell_checksum(cell, lab), with_score);
  const std::string with_frame = cell_checksum(cell, lab);
  folder.write("flight/frames.csv", "a,1\nc,2\n");
  EXPECT_NE(cell_checksum(cell, lab), with_frame) << "as long as before, but another text";
  // Images may lie in a linked folder.
  std::filesystem::create_directory(folder.path() / "images");
  const std::filesystem::path image = folder.write("images/a.png", "pixels");
  std::filesystem::create_directory_symlink(folder.path() / "images", folder.path() / "flight" / "images");
  const std::string with_image = cell_checksum(cell, lab);
  EXPECT_EQ(cell_checksum(cell, lab), with_image);
  folder.write("images/a.png", "fewer");
  EXPECT_NE(cell_checksum(cell, lab), with_image);
  const std::string as_long = cell_checksum(cell, lab);
  std::filesystem::last_write_time(image, std::filesystem::last_write_time(image) + std::chrono::seconds(2));
  EXPECT_NE(cell_checksum(cell, lab), as_long) << "changed at another time";
  std::filesystem::remove(folder.path() / "flight-2.csv");
  EXPECT_THAT(test::message_of<InputError>([&] { cell_checksum(cell, lab); }), HasSubstr("flight-2.csv"));
}

TEST(LabCell, ASequenceThatIsMissingIsNamed) {
  LabDescription lab = two_sweeps();
  lab.synthetic.reset();
  lab.sequences = {{"nowhere", 40}};
  EXPECT_THAT(test::message_of<InputError>([&] { cells_of(lab, "there"); }), HasSubstr("there/nowhere"));
}

}  // namespace
}  // namespace fabloop
