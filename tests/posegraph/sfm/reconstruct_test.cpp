// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruct.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "frontend/error.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/sfm/reconstruction_folder.h"
#include "posegraph/sfm/reconstruction_graph.h"
#include "posegraph/sfm/run_reader.h"
#include "tests/frontend/sequence/exif_jpeg.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

Sequence tiny_flight() { return read_sequence(testing_support::tiny_sequence()); }

ReconstructOptions tiny_options() {
  ReconstructOptions options;
  options.features.max_features = 400;
  options.candidates.num_training_features = 100;
  options.candidates.num_hypotheses = 5;
  options.num_threads = 2;
  return options;
}

Trajectory reference_of(const Sequence& sequence) {
  Trajectory reference;
  for (const Frame& frame : sequence.frames) reference.push_back({frame.time_ns, *frame.world_from_camera});
  return reference;
}

/// Reconstructed once for all tests of what comes after.
const Reconstructed& tiny_reconstruction() {
  static const Reconstructed result = reconstruct(tiny_flight(), std::nullopt, tiny_options());
  return result;
}

TEST(Reconstruct, PlacesAFlightFromItsImagesAlone) {
  const Sequence sequence = tiny_flight();
  const Reconstructed& result = tiny_reconstruction();
  EXPECT_EQ(result.reconstruction.images.size(), sequence.frames.size());
  EXPECT_TRUE(result.left_out.empty());
  EXPECT_LT(result.mean_error_px, 1.0);
  EXPECT_EQ(result.reconstruction.unit, LengthUnit::Arbitrary);
  const auto error =
      absolute_trajectory_error(trajectory_of(result.reconstruction), reference_of(sequence), {.alignment = Alignment::Sim3});
  ASSERT_TRUE(error);
  // Half a per cent of the flight's length; images of 240 pixels leave a few centimetres.
  EXPECT_LT(error->translation_m.rmse, 0.5);
}

TEST(Reconstruct, TakesTheUnitOfPositionsWhenAskedTo) {
  Sequence sequence = tiny_flight();
  sequence.frames.resize(12);  // more would only take longer
  ReconstructOptions options = tiny_options();
  for (const Frame& frame : sequence.frames) options.known_positions.push_back(frame.world_from_camera->translation);
  options.position_use = PositionUse::Align;
  options.georeference.sigma_m = 0.5;
  const Reconstructed result = reconstruct(sequence, std::nullopt, options);
  ASSERT_TRUE(result.georeference.found) << result.georeference.why_not;
  EXPECT_EQ(result.reconstruction.unit, LengthUnit::Metres);
  const auto error =
      absolute_trajectory_error(trajectory_of(result.reconstruction), reference_of(sequence), {.alignment = Alignment::None});
  EXPECT_LT(error->translation_m.rmse, 0.5);
}

/// Writes EXIF into an image that has none.
void label(const std::filesystem::path& image, const ExifFields& fields) {
  std::ifstream file(image, std::ios::binary);
  const std::vector<std::uint8_t> plain{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> labelled = with_exif(plain, fields);
  std::ofstream(image, std::ios::binary)
      .write(reinterpret_cast<const char*>(labelled.data()), static_cast<std::streamsize>(labelled.size()));
}

TEST(Reconstruct, SaysWhyImagesAreLeftOut) {
  const test::ScratchFolder folder;
  testing_support::copy_tiny_sequence(folder.path() / "flight", 12);
  const auto image_of = [&](std::size_t i) { return read_sequence(folder.path() / "flight").frames[i].image_path; };
  // Water, and another camera's image.
  const cv::Mat image = cv::imread(image_of(3).string());
  cv::imwrite(image_of(5).string(), cv::Mat(image.size(), CV_8UC3, cv::Scalar(120, 90, 60)));
  cv::imwrite(image_of(8).string(), image(cv::Rect(0, 0, image.cols / 2, image.rows)));
  // And one of the same size that another camera took, by its EXIF.
  for (std::size_t i = 0; i < 5; ++i) label(image_of(i), {.model = i == 2 ? "Phone" : "Camera"});
  const Reconstructed result = reconstruct(read_sequence(folder.path() / "flight"), std::nullopt, tiny_options());
  ASSERT_GE(result.left_out.size(), 3U);
  std::map<std::size_t, std::string> why;
  for (const LeftOutFrame& frame : result.left_out) why[frame.frame] = frame.why;
  EXPECT_NE(why[5].find("features"), std::string::npos) << why[5];
  EXPECT_NE(why[8].find("pixels"), std::string::npos) << why[8];
  EXPECT_NE(why[2].find("another camera (Phone) than most (Camera)"), std::string::npos) << why[2];
}

TEST(Reconstruct, RefusesImagesThatDoNotOverlap) {
  Sequence sequence = tiny_flight();
  sequence.frames = {sequence.frames[0], sequence.frames[11]};
  const std::string message = test::message_of<InputError>([&] { reconstruct(sequence, std::nullopt, tiny_options()); });
  EXPECT_NE(message.find("can be placed"), std::string::npos) << message;
}

TEST(ReconstructionGraph, HasLoopsThatTheReferenceBearsOut) {
  const Sequence sequence = tiny_flight();
  const Reconstructed& result = tiny_reconstruction();
  std::size_t num_loops = 0;
  for (const LoopEvent& event : reconstruction_loops(result)) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.verification.verdict != Verdict::Accepted) continue;
      ++num_loops;
      EXPECT_FALSE(outcome.verification.has_scale);
      const Pose truth =
          sequence.frames[outcome.match].world_from_camera->inverse() * *sequence.frames[event.query].world_from_camera;
      const Pose& found = outcome.verification.match_from_query;
      constexpr double kMaxAngle_deg = 3;
      EXPECT_LT(deg_from_rad(rotation_angle(found.rotation.conjugate() * truth.rotation)), kMaxAngle_deg);
    }
  }
  EXPECT_GT(num_loops, 0U);  // the flight comes back to its start
}

TEST(ReconstructionFolder, HasThePublicFiles) {
  const test::ScratchFolder folder;
  const Sequence sequence = tiny_flight();
  const auto run = folder.path() / "run";
  write_reconstruction_folder(run, sequence, tiny_reconstruction(), tiny_options());
  EXPECT_EQ(read_tum(run / "trajectory.tum").size(), sequence.frames.size());
  EXPECT_EQ(read_frame_times(run / "frames.csv").size(), sequence.frames.size());
  EXPECT_EQ(read_g2o(run / "graph.g2o").vertices.size(), sequence.frames.size());
  EXPECT_FALSE(read_loops(run / "loops.csv").empty());
  EXPECT_FALSE(cv::imread((run / "map.png").string()).empty());
  EXPECT_GT(std::filesystem::file_size(run / "points.ply"), tiny_reconstruction().reconstruction.points.size() * 15);
  std::ifstream file(run / "summary.json");
  const auto summary = nlohmann::json::parse(file);
  EXPECT_EQ(summary["unit"], "arbitrary");
  EXPECT_EQ(summary["frames"]["mapped"], sequence.frames.size());
  EXPECT_EQ(summary["mean_reprojection_error_px"], tiny_reconstruction().mean_error_px);
  EXPECT_LT(summary["ate"]["final"]["rmse_m"], 0.5);
  EXPECT_TRUE(summary["rolling_shutter"]["modelled_readout_s"].is_null());
  EXPECT_EQ(summary["rolling_shutter"]["is_certain"], false);  // simulated cameras see all rows at once
  const Reconstruction read = read_map_run(run, sequence.frames.front().image_path.parent_path()).reconstruction;
  EXPECT_EQ(read.unit, LengthUnit::Arbitrary);
  ASSERT_EQ(read.images.size(), tiny_reconstruction().reconstruction.images.size());
  EXPECT_EQ(read.images.back().frame, tiny_reconstruction().reconstruction.images.back().frame);
  ASSERT_EQ(read.points.size(), tiny_reconstruction().reconstruction.points.size());
  EXPECT_EQ(read.points.front().track.size(), tiny_reconstruction().reconstruction.points.front().track.size());
}

TEST(Reconstruct, IsMadeUnderAKnownReadout) {
  const test::ScratchFolder folder;
  const Sequence sequence = tiny_flight();
  ReconstructOptions options = tiny_options();
  options.rolling_shutter.shutter = Shutter::RollingKnown;
  options.rolling_shutter.readout_s = 0.02;
  const Reconstructed result = reconstruct(sequence, std::nullopt, options);
  ASSERT_TRUE(result.modelled_readout);
  EXPECT_EQ(result.modelled_readout->readout_s, 0.02);
  EXPECT_EQ(result.reconstruction.images.size(), sequence.frames.size());
  EXPECT_FALSE(result.reconstruction.images.front().readout.shift_in_world.isZero(0));
  // The result's sightings err as the segment's did: each image has its readout.
  double sum_px = 0;
  for (const ScenePoint& point : result.reconstruction.points) {
    for (const Sighting& sighting : point.track) {
      const Camera& camera = result.reconstruction.cameras.front();
      const Pose world_from_row = pose_at_sighting(result.reconstruction, sighting);
      sum_px += reprojection_error_px(camera, world_from_row, point.x_in_world, sighting.pixel);
    }
  }
  EXPECT_NEAR(sum_px / static_cast<double>(result.num_sightings), result.mean_error_px, 1e-9);
  const auto run = folder.path() / "run";
  write_reconstruction_folder(run, sequence, result, options);
  std::ifstream file(run / "summary.json");
  EXPECT_EQ(nlohmann::json::parse(file)["rolling_shutter"]["modelled_readout_s"], 0.02);
}

TEST(Reconstruct, RefusesAReadoutOfImagesWithoutTimes) {
  const test::ScratchFolder folder;
  testing_support::copy_tiny_sequence(folder.path() / "flight", 3);
  for (const char* name : {"frames.csv", "track.csv", "reference.tum"}) std::filesystem::remove(folder.path() / "flight" / name);
  const Sequence sequence = read_sequence(folder.path() / "flight");
  ASSERT_FALSE(sequence.has_times);
  ReconstructOptions options = tiny_options();
  options.rolling_shutter.shutter = Shutter::RollingKnown;
  options.rolling_shutter.readout_s = 0.02;
  const std::string message = test::message_of<InputError>([&] { reconstruct(sequence, std::nullopt, options); });
  EXPECT_NE(message.find("no time stamps"), std::string::npos) << message;
}

}  // namespace
}  // namespace fabloop
