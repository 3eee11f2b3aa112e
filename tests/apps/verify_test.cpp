// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/apps/program.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

/// The first images of the tiny flight; neighbours overlap.
class VerifyCommand : public testing::Test {
 protected:
  VerifyCommand() : flight_(scratch_.path() / "flight"), out_(scratch_.path() / "out") {
    copy_tiny_sequence(flight_, 3);
    for (const auto& entry : fs::directory_iterator(flight_ / "images")) images_.insert(entry.path());
  }

  std::string image(std::size_t i) const { return std::next(images_.begin(), static_cast<std::ptrdiff_t>(i))->string(); }
  std::string camera() const { return (flight_ / "camera.yaml").string(); }

  ProgramResult run(const std::string& a, const std::string& b, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"verify", a, b, "--camera", camera(), "--max-features", "400"});
    return run_fabloop(more);
  }

  /// A picture without any texture, as large as the others.
  std::string blank() const {
    const fs::path path = scratch_.path() / "blank.png";
    cv::imwrite(path.string(), cv::Mat1b(cv::imread(image(0), cv::IMREAD_GRAYSCALE).size(), 128));
    return path.string();
  }

  test::ScratchFolder scratch_;
  fs::path flight_, out_;
  std::set<fs::path> images_;
};

TEST_F(VerifyCommand, SaysThatNeighboursShowOnePlaceAndWhy) {
  const fs::path picture = scratch_.path() / "pair.png";
  const ProgramResult result = run(image(1), image(0), {"--picture", picture.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("Accepted: both show one place"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("pose of A in B"), std::string::npos) << result.out;
  for (const char* figure : {"inliers", "at least 15", "log10_false_alarms", "cell_share"})
    EXPECT_NE(result.out.find(figure), std::string::npos) << figure;
  EXPECT_EQ(result.out.find("FAILS"), std::string::npos) << result.out;
  EXPECT_FALSE(cv::imread(picture.string()).empty());
}

TEST_F(VerifyCommand, IsDoneWhateverTheVerdict) {
  const ProgramResult result = run(image(0), blank());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("TooFewMatches"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("FAILS"), std::string::npos) << result.out;
}

TEST_F(VerifyCommand, WritesAFolderAndPrintsTheSameJson) {
  const ProgramResult result = run(image(1), image(0), {"--out", out_.string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, bytes_of(out_ / "verification.json"));
  EXPECT_FALSE(cv::imread((out_ / "pair.png").string()).empty());
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("verdict"), "Accepted");
  const auto& inliers = json.at("figures").at("inliers");
  EXPECT_EQ(inliers.at("at_least"), 15.0);
  EXPECT_GE(inliers.at("value").get<double>(), 15.0);
  EXPECT_EQ(inliers.at("passed"), true);
  EXPECT_EQ(json.at("match_from_query").at("rotation_xyzw").size(), 4u);
  expect_refused(run(image(1), image(0), {"--out", out_.string()}), out_.string());
  EXPECT_EQ(run(image(1), image(0), {"--out", out_.string(), "--overwrite"}).exit_code, 0);
}

TEST_F(VerifyCommand, TakesASecondCameraForAnImageOfAnotherSize) {
  const fs::path half = scratch_.path() / "half.png";
  cv::Mat smaller;
  cv::resize(cv::imread(image(0), cv::IMREAD_GRAYSCALE), smaller, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::imwrite(half.string(), smaller);
  expect_refused(run(image(1), half.string()), half.string());
  const std::string width = std::to_string(smaller.cols), height = std::to_string(smaller.rows);
  const fs::path camera_b =
      scratch_.write("half.yaml", "image_width: " + width + "\nimage_height: " + height + "\ncamera_matrix: {data: [" + width +
                                      ", 0, " + std::to_string(smaller.cols / 2) + ", 0, " + width + ", " +
                                      std::to_string(smaller.rows / 2) + ", 0, 0, 1]}\n");
  const ProgramResult result =
      run(image(1), half.string(), {"--camera-b", camera_b.string(), "--picture", (scratch_.path() / "p.png").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(VerifyCommand, RefusesBadInput) {
  const std::string missing = (scratch_.path() / "missing.jpg").string();
  expect_refused(run(missing, image(0)), missing);
  expect_refused(run(image(0), image(1), {"--camera-b", missing}), missing);
  expect_refused(run(image(0), image(1), {"--features", "fast+akaze"}), "fast+sift");
  expect_refused(run(image(0), image(1), {"--picture", (scratch_.path() / "no" / "where.png").string()}), "where.png");
}

TEST(VerifyUsage, NeedsTwoImagesAndACamera) {
  EXPECT_EQ(run_fabloop({"verify", "a.png", "b.png"}).exit_code, 2);
  EXPECT_EQ(run_fabloop({"verify", "a.png", "--camera", "c.yaml"}).exit_code, 2);
  EXPECT_EQ(run_fabloop({"verify", "a.png", "b.png", "--camera", "c.yaml", "--max-ratio", "2"}).exit_code, 2);
}

}  // namespace
}  // namespace fabloop
