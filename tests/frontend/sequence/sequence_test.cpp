// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/sequence.h"

#include <gmock/gmock.h>

#include "frontend/sequence/association.h"
#include "tests/frontend/sequence/exif_jpeg.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void write_images(const TemporaryFolder& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) folder.write(name, encoded_image(".png"));
}

std::vector<std::string> names_of(const Sequence& sequence) {
  std::vector<std::string> names;
  for (const Frame& frame : sequence.frames) names.push_back(frame.image_path.filename().string());
  return names;
}

std::vector<std::int64_t> times_of(const Sequence& sequence) {
  std::vector<std::int64_t> times;
  for (const Frame& frame : sequence.frames) times.push_back(frame.time_ns);
  return times;
}

/// A folder of three images, 10 s apart from 100 s on, with a calibration.
struct ThreeImages {
  TemporaryFolder folder;
  std::vector<std::string> warnings;
  SequenceOptions options;

  ThreeImages() {
    write_images(folder, {"images/a.png", "images/b.png", "images/c.png"});
    folder.write("frames.csv", "a.png,100\nb.png,110\nc.png,120\n");
    folder.write("camera.yaml", kCameraYaml);
    options.warn = [this](const std::string& message) { warnings.push_back(message); };
  }
  Sequence read() const { return read_sequence(folder.path(), options); }
  std::string error() const {
    return input_error_of([&] { read(); });
  }
};

TEST(Sequence, ReadsImagesStampsCameraOdometryAndReference) {
  ThreeImages three;
  three.folder.write("reference.tum", "110 1 2 3 0 0 0 1\n");
  three.options.odometry = three.folder.write("odometry.tum", "100 0 0 0 0 0 0 1\n110.009 5 0 0 0 0 0 1\n120 6 0 0 0 0 0 1\n");
  const Sequence sequence = read_sequence(three.folder.path() / "", three.options);
  EXPECT_EQ(sequence.name, three.folder.path().filename().string());
  EXPECT_EQ(sequence.camera.fx, 50.5);
  EXPECT_THAT(names_of(sequence), ElementsAre("a.png", "b.png", "c.png"));
  EXPECT_THAT(times_of(sequence), ElementsAre(100'000'000'000, 110'000'000'000, 120'000'000'000));
  ASSERT_TRUE(sequence.frames[1].odom_from_camera.has_value());
  EXPECT_EQ(sequence.frames[1].odom_from_camera->translation.x(), 5);
  EXPECT_FALSE(sequence.frames[0].world_from_camera.has_value());
  ASSERT_TRUE(sequence.frames[1].world_from_camera.has_value());
  EXPECT_EQ(sequence.frames[1].world_from_camera->translation.z(), 3);
  EXPECT_THAT(three.warnings, IsEmpty());
}

TEST(Sequence, OdometryIsReadOnlyWhenAskedFor) {
  ThreeImages three;
  three.folder.write("odometry.tum", "100 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(three.read().frames[0].odom_from_camera.has_value());
}

TEST(Sequence, StampsComeFromTrackCsvFromNamesOrFromTheOrder) {
  const TemporaryFolder folder;
  folder.write("camera.yaml", kCameraYaml);
  write_images(folder, {"img10.png", "img9.png", "notes.txt"});
  EXPECT_THAT(names_of(read_sequence(folder.path())), ElementsAre("img9.png", "img10.png"));
  EXPECT_THAT(times_of(read_sequence(folder.path())), ElementsAre(0, 1'000'000'000));
  folder.write("track.csv", "filename,timestamp_s\r\nimg10.png,5\r\nimg9.png,6\r\n");
  EXPECT_THAT(names_of(read_sequence(folder.path())), ElementsAre("img10.png", "img9.png"));
}

TEST(Sequence, FileNamesMayBeTimes) {
  const TemporaryFolder folder;
  folder.write("camera.yaml", kCameraYaml);
  write_images(folder, {"1305031102.175304.png", "1305031102.2.png"});
  EXPECT_THAT(times_of(read_sequence(folder.path())), ElementsAre(1305031102175304000, 1305031102200000000));
  write_images(folder, {"images/1403636579763555584.png", "images/1403636579813555456.png"});
  EXPECT_THAT(times_of(read_sequence(folder.path())), ElementsAre(1403636579763555584, 1403636579813555456));
}

TEST(Sequence, WithoutCalibrationTheFocalLengthIsGuessedAndSaidToBe) {
  const TemporaryFolder folder;
  folder.write("a.jpg", jpeg_with_exif({.focal_length_um = 4000, .focal_length_35mm = 26}));
  std::vector<std::string> warnings;
  SequenceOptions options;
  options.warn = [&](const std::string& message) { warnings.push_back(message); };
  EXPECT_NEAR(read_sequence(folder.path(), options).camera.fx, 26.0 / 43.2666 * 80.0, 0.01);
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("guess"), HasSubstr("a.jpg"), HasSubstr("48 px"))));
}

TEST(Sequence, AFolderThatIsNoneIsNamed) {
  const TemporaryFolder folder;
  const auto message = [](const fs::path& path) { return input_error_of([&] { read_sequence(path); }); };
  EXPECT_THAT(message(folder.path() / "absent"), AllOf(HasSubstr("absent"), HasSubstr("no such folder")));
  EXPECT_THAT(message(folder.write("file", "text")), AllOf(HasSubstr("file"), HasSubstr("is a file")));
  EXPECT_THAT(message(folder.path()), AllOf(HasSubstr(folder.path().string()), HasSubstr("holds no images")));
}

TEST(Sequence, AnImageThatTheCsvNamesMustExist) {
  ThreeImages three;
  three.folder.write("frames.csv", "# head\na.png,1\nmissing.png,2\n");
  EXPECT_THAT(three.error(), AllOf(HasSubstr("frames.csv:3"), HasSubstr("'missing.png'")));
}

TEST(Sequence, ImagesThatTheCsvLeavesOutAreMentioned) {
  ThreeImages three;
  three.folder.write("frames.csv", "a.png,1\n");
  EXPECT_EQ(three.read().frames.size(), 1u);
  EXPECT_THAT(three.warnings, ElementsAre(AllOf(HasSubstr("frames.csv"), HasSubstr("1 of 3"))));
}

TEST(Sequence, NeitherCalibrationNorExifSaysHowToMendIt) {
  ThreeImages three;
  fs::remove(three.folder.path() / "camera.yaml");
  EXPECT_THAT(three.error(), AllOf(HasSubstr("no camera.yaml"), HasSubstr("EXIF of a.png"), HasSubstr("camera_info")));
  three.options.camera = three.folder.path() / "elsewhere.yaml";
  EXPECT_THAT(three.error(), HasSubstr("elsewhere.yaml: cannot be read"));
  three.options.camera = three.folder.write("elsewhere.yaml", kCameraYaml);
  EXPECT_EQ(three.read().camera.fy, 51.5);
}

TEST(Sequence, OdometryOfAnotherTimePrintsBothSpans) {
  ThreeImages three;
  three.options.odometry = three.folder.write("late.tum", "500 0 0 0 0 0 0 1\n600 0 0 0 0 0 0 1\n");
  EXPECT_THAT(three.error(), AllOf(HasSubstr("late.tum"), HasSubstr("500.000000000 to 600.000000000"),
                                   HasSubstr("100.000000000 to 120.000000000")));
}

TEST(Sequence, FramesWithoutOdometryAreCountedInAWarning) {
  ThreeImages three;
  three.options.odometry = three.folder.write("odometry.tum", "100 0 0 0 0 0 0 1\n110.5 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(three.read().frames[1].odom_from_camera.has_value());
  EXPECT_THAT(three.warnings, ElementsAre(AllOf(HasSubstr("odometry.tum"), HasSubstr("2 of 3 frames"))));
  three.options.max_time_difference_s = 0.5;
  EXPECT_TRUE(three.read().frames[1].odom_from_camera.has_value());
  three.options.max_time_difference_s = -1;
  EXPECT_THAT(three.error(), HasSubstr("max_time_difference_s"));
}

TEST(Association, TakesTheNearestAndTheEarlierOfEquals) {
  const auto pose = [](double x) { return Pose{Eigen::Quaterniond::Identity(), {x, 0, 0}}; };
  const Trajectory trajectory{{0, pose(0)}, {10, pose(10)}, {20, pose(20)}};
  const auto poses = poses_at(trajectory, {-6, -5, 4, 5, 6, 15, 24, 26}, 5);
  std::vector<double> found;
  for (const auto& found_pose : poses) found.push_back(found_pose ? found_pose->translation.x() : -1);
  EXPECT_THAT(found, ElementsAre(-1, 0, 0, 0, 10, 10, 20, -1));
  EXPECT_FALSE(poses_at({{std::numeric_limits<std::int64_t>::min(), pose(0)}}, {std::numeric_limits<std::int64_t>::max()}, 5)[0]);
}

TEST(RealSequences, AreReadWithTheirOdometryAndReference) {
  const fs::path aerial = fs::path(FABLOOP_SHARED_DATA_DIR) / "aerial";
  if (!fs::exists(aerial)) GTEST_SKIP() << "real sequences are absent: " << aerial.string();
  const std::vector<std::pair<std::string, std::size_t>> sizes{{"sheffield_cross", 172}, {"caliterra", 75}, {"seneca", 167}};
  for (const auto& [name, size] : sizes) {
    SequenceOptions options;
    options.odometry = aerial / name / "odometry.tum";
    const Sequence sequence = read_sequence(aerial / name, options);
    EXPECT_EQ(sequence.name, name);
    ASSERT_EQ(sequence.frames.size(), size);
    const Frame& first = sequence.frames.front();
    EXPECT_TRUE(first.odom_from_camera && first.world_from_camera);
    EXPECT_FALSE(read_gray_image(first.image_path, sequence.camera).empty());
  }
}

}  // namespace
}  // namespace fabloop
