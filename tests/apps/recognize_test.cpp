// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "frontend/npy.h"
#include "frontend/sequence/image_folder.h"
#include "tests/apps/program.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/tiny_sequence.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;
using testing::HasSubstr;

/// The tiny flight, a small ORB model of its first images, and an empty folder to write to.
class Recognize : public testing::Test {
 protected:
  Recognize()
      : sequence_(scratch_.path() / "flight"), model_(scratch_.path() / "orb.model"), out_folder_(scratch_.path() / "out") {
    copy_tiny_sequence(sequence_, kNumImages);
    fs::create_directory(out_folder_);
    train({sequence_.string()}, model_);
  }

  static void train(std::vector<std::string> more, const fs::path& model) {
    more.insert(more.begin(), "train");
    for (const char* word : {"--features", "orb", "--max-features", "150", "--words", "300", "--quiet", "--overwrite", "--out"}) {
      more.emplace_back(word);
    }
    more.push_back(model.string());
    const ProgramResult trained = run_fabloop(more);
    EXPECT_EQ(trained.exit_code, 0) << trained.err;
  }

  ProgramResult recognize(const std::vector<std::string>& more = {}) const { return recognize(sequence_, more); }

  ProgramResult recognize(const fs::path& sequence, const std::vector<std::string>& more) const {
    std::vector<std::string> command = {"recognize", sequence.string(), "--model", model_.string(),
                                        "--out",     run().string(),    "--quiet", "--overwrite"};
    command.insert(command.end(), more.begin(), more.end());
    return run_fabloop(command);
  }

  void expect_recognize_refused(const std::string& culprit, const std::vector<std::string>& more) const {
    expect_refused(recognize(more), culprit);
    expect_empty(out_folder_);
  }

  fs::path run() const { return out_folder_ / "run"; }
  nlohmann::json summary() const { return nlohmann::json::parse(bytes_of(run() / "summary.json")); }

  /// The first images as a video of two a second.
  fs::path write_video() const {
    const fs::path path = scratch_.path() / "flight.avi";
    cv::VideoWriter writer;
    for (const fs::path& image : list_images(sequence_ / "images")) {
      const cv::Mat picture = cv::imread(image.string());
      if (!writer.isOpened()) writer.open(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 2.0, picture.size());
      writer.write(picture);
    }
    return path;
  }

  static constexpr std::size_t kNumImages = 8;
  test::ScratchFolder scratch_;
  fs::path sequence_;
  fs::path model_;
  fs::path out_folder_;
};

std::size_t count_lines(const std::string& text) { return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')); }

TEST_F(Recognize, WritesEveryFileOfARunAndJudgesIt) {
  const ProgramResult result = recognize({"--window", "1", "--truth", sequence_.string(), "--top", "3"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.err.empty()) << result.err;
  EXPECT_THAT(result.out, HasSubstr("by these rules: "));
  for (const char* name : {"posterior.png", "log_likelihood.png", "precision_recall.png"}) {
    EXPECT_FALSE(cv::imread((run() / name).string()).empty()) << name;
  }
  for (const char* name : {"posterior.npy", "log_likelihood.npy"}) {
    NpyReader matrix(run() / name);
    EXPECT_EQ(matrix.num_rows(), kNumImages) << name;
    EXPECT_EQ(matrix.num_columns(), kNumImages) << name;
    EXPECT_EQ(matrix.type(), NpyType::Float32);
  }
  EXPECT_EQ(count_lines(bytes_of(run() / "places.csv")), 1 + kNumImages);
  EXPECT_THAT(bytes_of(run() / "hypotheses.csv"),
              HasSubstr("query,rank,place,match_frame,match_time_s,probability,log_likelihood"));
  EXPECT_THAT(bytes_of(run() / "precision_recall.csv"), HasSubstr("threshold_log_odds,precision,recall"));
  const nlohmann::json figures = summary();
  EXPECT_EQ(figures.at("places"), kNumImages);
  EXPECT_THAT(figures.at("precision_recall").at("recipe").get<std::string>(), HasSubstr("top-1"));
  EXPECT_EQ(figures.at("timings").at("recognise").at("count"), kNumImages);
  for (const auto& entry : fs::directory_iterator(run()))
    EXPECT_NE(entry.path().extension(), ".rows") << "a scratch file was left";
}

TEST_F(Recognize, ThePosteriorSumsToOneWithTheNewPlace) {
  ASSERT_EQ(recognize({"--float64", "--window", "2"}).exit_code, 0);
  NpyReader posterior(run() / "posterior.npy");
  ASSERT_EQ(posterior.type(), NpyType::Float64);
  std::ifstream places(run() / "places.csv");
  std::string line;
  std::getline(places, line);
  std::vector<double> row(posterior.num_columns());
  for (std::size_t i = 0; i < posterior.num_rows(); ++i) {
    posterior.read_row(row);
    ASSERT_TRUE(std::getline(places, line));
    double sum = 0.0;
    for (const double p : row) sum += p;
    std::string p_new = line;
    for (int column = 0; column < 4; ++column) p_new.erase(0, p_new.find(',') + 1);
    EXPECT_NEAR(sum + std::stod(p_new), 1.0, 1e-9) << line;
  }
}

TEST_F(Recognize, AnImageIsFoundInAMapOfItself) {
  // Without motion: what an image looks like decides alone.
  ASSERT_EQ(recognize({"--map", sequence_.string(), "--new-place", "off", "--p-teleport", "1"}).exit_code, 0);
  std::ifstream hypotheses(run() / "hypotheses.csv");
  std::string line;
  std::getline(hypotheses, line);
  std::size_t num_best = 0;
  while (std::getline(hypotheses, line)) {
    const std::string query = line.substr(0, line.find(','));
    const bool is_best = line.starts_with(query + ",1,");
    num_best += is_best;
    if (!is_best) continue;
    EXPECT_TRUE(line.starts_with(query + ",1," + query + "," + query + ",")) << line;
  }
  EXPECT_EQ(num_best, kNumImages);
  EXPECT_EQ(summary().at("mean_p_new"), 0.0);
  EXPECT_EQ(count_lines(bytes_of(run() / "map_places.csv")), 1 + kNumImages);
}

TEST_F(Recognize, VideosAreTrainedOnAndRecognised) {
  const fs::path video = write_video();
  train({video.string(), "--rate", "1"}, model_);
  ASSERT_EQ(recognize(video, {"--every", "2"}).exit_code, 0);
  EXPECT_EQ(summary().at("frames").at("images"), kNumImages / 2);
  EXPECT_EQ(summary().at("model").at("training_images"), kNumImages / 2);
  EXPECT_FALSE(fs::exists(model_.string() + ".descriptors"));
  fs::resize_file(video, fs::file_size(video) / 2);
  EXPECT_EQ(recognize(video, {}).exit_code, 0) << "a part is better than nothing";
  expect_refused(recognize(video, {"--strict"}), "flight.avi");
}

TEST_F(Recognize, TheSameRunGivesTheSameFilesWithAnyNumberOfThreads) {
  const std::vector<std::string> names = {"posterior.npy", "log_likelihood.npy", "hypotheses.csv", "places.csv", "posterior.png"};
  ASSERT_EQ(recognize({"--threads", "1", "--revisit", "threshold"}).exit_code, 0);
  std::vector<std::string> first;
  for (const std::string& name : names) first.push_back(bytes_of(run() / name));
  ASSERT_EQ(recognize({"--threads", "3", "--revisit", "threshold", "--engine", "exact"}).exit_code, 0);
  for (const char* name : {"places.csv"}) EXPECT_EQ(count_lines(bytes_of(run() / name)), count_lines(first[3]));
  ASSERT_EQ(recognize({"--threads", "3", "--revisit", "threshold"}).exit_code, 0);
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(bytes_of(run() / names[i]), first[i]) << names[i];
}

TEST_F(Recognize, DamagedImagesAreSkippedAndCountedOrRefused) {
  std::ofstream(sequence_ / "images" / "0003.jpg") << "this is no image";
  ASSERT_EQ(recognize().exit_code, 0);
  EXPECT_EQ(summary().at("frames").at("damaged"), 1);
  EXPECT_EQ(summary().at("frames").at("images"), kNumImages - 1);
  fs::remove_all(run());
  expect_recognize_refused("0003.jpg", {"--strict"});
}

TEST_F(Recognize, BadInputIsRefused) {
  expect_recognize_refused("absent.csv", {"--method", "absent.csv"});
  expect_recognize_refused("absent", {"--map", "absent"});
  expect_recognize_refused("absent", {"--truth", "absent"});
  expect_recognize_refused("--map-truth", {"--map", sequence_.string(), "--truth", (sequence_ / "reference.tum").string()});
  expect_recognize_refused("p-seen-if-present", {"--p-seen-if-present", "0.1", "--p-seen-if-absent", "0.2"});
  const fs::path matrix = scratch_.path() / "loops.txt";
  std::ofstream(matrix) << "0 1\n1 0\n";
  expect_recognize_refused("frame 2", {"--truth", matrix.string()});
  std::ofstream(matrix) << "0 1\n1\n";
  expect_recognize_refused("loops.txt:2", {"--truth", matrix.string()});
  std::ofstream(model_) << "no model";
  expect_recognize_refused("orb.model", {});
  fs::remove(model_);
  expect_recognize_refused("orb.model", {});
}

TEST_F(Recognize, OtherMethodsAreJudgedAlikeAndAFileOfScoresAsTheMethodThatMadeThem) {
  for (const char* method : {"tf-idf", "vlad", "seqslam"}) {
    ASSERT_EQ(recognize({"--method", method, "--window", "1", "--top", "100", "--truth", sequence_.string()}).exit_code, 0)
        << method;
    EXPECT_FALSE(cv::imread((run() / "precision_recall.png").string()).empty()) << method;
    NpyReader scores(run() / "scores.npy");
    EXPECT_EQ(scores.num_rows(), kNumImages);
    const std::string curve = bytes_of(run() / "precision_recall.csv");
    EXPECT_THAT(curve, HasSubstr("threshold_score,precision,recall"));
    const nlohmann::json judged = summary().at("precision_recall");
    const fs::path file = scratch_.path() / "mine.csv";
    fs::copy_file(run() / "hypotheses.csv", file, fs::copy_options::overwrite_existing);
    // No model: the file knows all.
    ASSERT_EQ(run_fabloop({"recognize", sequence_.string(), "--out", run().string(), "--quiet", "--overwrite", "--method",
                           file.string(), "--window", "1", "--top", "100", "--truth", sequence_.string()})
                  .exit_code,
              0);
    EXPECT_EQ(bytes_of(run() / "precision_recall.csv"), curve) << method;
    EXPECT_EQ(summary().at("precision_recall"), judged) << method;
    EXPECT_EQ(summary().at("label"), "scores of mine.csv");
  }
}

TEST_F(Recognize, NaiveBayesIsAMethodToo) {
  ASSERT_EQ(recognize({"--method", "naive-bayes"}).exit_code, 0);
  const std::string method = bytes_of(run() / "hypotheses.csv");
  ASSERT_EQ(recognize({"--naive-bayes"}).exit_code, 0);
  EXPECT_EQ(bytes_of(run() / "hypotheses.csv"), method);
}

TEST_F(Recognize, WrongUsageIsTold) {
  EXPECT_EQ(recognize({"--method", "dbow"}).exit_code, 2);
  EXPECT_EQ(recognize({"--method", "vlad", "--p-new", "0.5"}).exit_code, 2) << "VLAD does not know new places";
  EXPECT_EQ(run_fabloop({"recognize", sequence_.string(), "--out", run().string(), "--method", "vlad"}).exit_code, 2)
      << "no model";
  EXPECT_EQ(recognize({"--method", "vlad", "--map", sequence_.string(), "--window", "3"}).exit_code, 2)
      << "VLAD leaves out no place of a map";
  EXPECT_EQ(recognize({"--engine", "steam"}).exit_code, 2);
  EXPECT_EQ(recognize({"--p-new", "1.5"}).exit_code, 2);
  EXPECT_EQ(recognize({"--every", "0"}).exit_code, 2);
  EXPECT_EQ(run_fabloop({"recognize", "--quiet"}).exit_code, 2);
}

}  // namespace
}  // namespace fabloop
