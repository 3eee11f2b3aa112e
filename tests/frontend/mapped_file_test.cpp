// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/mapped_file.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

class MappedFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::path(::testing::TempDir()) / (std::string("fabloop_mapped_") + test->name());
  }
  void TearDown() override { fs::remove(path_); }

  void write(const std::array<float, 6>& numbers) const {
    std::ofstream(path_, std::ios::binary).write(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
  }

  fs::path path_;
};

TEST_F(MappedFileTest, OutlivesItsFileInTheMatricesMadeOfIt) {
  write({1, 2, 3, 4, 5, 6});
  cv::Mat copy;
  {
    MappedFile file(path_);
    ASSERT_EQ(file.size(), 24u);
    MappedFile moved(std::move(file));
    const cv::Mat matrix = matrix_of(std::move(moved), 8, 2, 2, CV_32F);
    fs::remove(path_);
    copy = matrix.row(1);
  }
  EXPECT_EQ(copy.at<float>(0, 0), 5.0F);
  EXPECT_EQ(copy.at<float>(0, 1), 6.0F);
}

TEST_F(MappedFileTest, KeepsWhatIsWrittenToItself) {
  write({1, 2, 3, 4, 5, 6});
  cv::Mat matrix = matrix_of(MappedFile(path_), 0, 2, 3, CV_32F);
  matrix.at<float>(1, 1) = 50;
  EXPECT_EQ(matrix.at<float>(1, 1), 50.0F);
  EXPECT_EQ(matrix_of(MappedFile(path_), 0, 2, 3, CV_32F).at<float>(1, 1), 5.0F);
}

TEST_F(MappedFileTest, RefusesWhatCannotBeRead) {
  EXPECT_THROW(MappedFile{path_}, InputError);
  EXPECT_THROW(MappedFile{path_.parent_path()}, InputError);
  std::ofstream{path_};
  EXPECT_EQ(MappedFile(path_).size(), 0u);
}

}  // namespace
}  // namespace fabloop
