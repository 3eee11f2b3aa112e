// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "frontend/sequence/image_completeness.h"
#include "frontend/sequence/sequence.h"
#include "tests/frontend/sequence/exif_jpeg.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Camera camera_of_size(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  return camera;
}

const Camera kCamera = camera_of_size(64, 48);

std::string error_of_image(const std::filesystem::path& path) {
  return input_error_of([&] { read_gray_image(path, kCamera); });
}

TEST(Image, ReadsEveryUsualFormatAsGrey) {
  const TemporaryFolder folder;
  for (const std::string extension : {".jpg", ".png", ".bmp", ".pgm", ".tif"}) {
    const cv::Mat image = read_gray_image(folder.write("a" + extension, encoded_image(extension)), kCamera);
    EXPECT_EQ(image.type(), CV_8UC1) << extension;
    EXPECT_EQ(image.size(), cv::Size(64, 48)) << extension;
  }
}

TEST(Image, ATruncatedFileIsNamedWhereverItEnds) {
  const TemporaryFolder folder;
  for (const std::string extension : {".jpg", ".png", ".bmp", ".pgm", ".tif"}) {
    const auto whole = encoded_image(extension);
    for (std::size_t size = 1; size < whole.size(); size += 1 + whole.size() / 17) {
      const auto path = folder.write("cut" + extension,
                                     std::vector<std::uint8_t>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
      EXPECT_THAT(error_of_image(path), HasSubstr("cut" + extension)) << size << " of " << whole.size() << " bytes";
    }
  }
}

TEST(Image, AThumbnailsEndIsNotTheImages) {
  auto jpeg = encoded_image(".jpg");
  const std::vector<std::uint8_t> thumbnail{0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD8, 0xFF, 0xD9};
  jpeg.insert(jpeg.begin() + 2, thumbnail.begin(), thumbnail.end());
  EXPECT_TRUE(is_complete_image(jpeg));
  jpeg.resize(jpeg.size() - 2);
  EXPECT_FALSE(is_complete_image(jpeg));
}

TEST(Image, BytesAfterTheEndDoNotMatter) {
  for (const std::string extension : {".jpg", ".png"}) {
    auto bytes = encoded_image(extension);
    bytes.resize(bytes.size() + 1000, 0);
    EXPECT_TRUE(is_complete_image(bytes)) << extension;
    const TemporaryFolder folder;
    EXPECT_FALSE(read_gray_image(folder.write("padded" + extension, bytes), kCamera).empty());
  }
}

TEST(Image, ProgressiveJpegsWithRestartsAreComplete) {
  std::vector<std::uint8_t> bytes;
  cv::Mat image(300, 400, CV_8UC3);
  cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  EXPECT_TRUE(is_complete_image(bytes));
  bytes.resize(bytes.size() / 2);
  EXPECT_FALSE(is_complete_image(bytes));
}

TEST(Image, DamageIsNamed) {
  const TemporaryFolder folder;
  auto png = encoded_image(".png");
  png[png.size() / 2] ^= 0xFF;
  EXPECT_THAT(error_of_image(folder.write("bent.png", png)), AllOf(HasSubstr("bent.png"), HasSubstr("damaged")));
  EXPECT_THAT(error_of_image(folder.write("text.jpg", "no image")), AllOf(HasSubstr("text.jpg"), HasSubstr("damaged")));
  EXPECT_THAT(error_of_image(folder.write("empty.jpg", "")), AllOf(HasSubstr("empty.jpg"), HasSubstr("empty")));
  EXPECT_THAT(error_of_image(folder.path() / "absent.jpg"), HasSubstr("absent.jpg: the image cannot be read"));
  EXPECT_THAT(error_of_image(folder.path()), HasSubstr("cannot be read"));
}

TEST(Image, ASizeOtherThanTheCamerasIsNamed) {
  const TemporaryFolder folder;
  const auto path = folder.write("wide.png", encoded_image(".png", 80, 48));
  EXPECT_THAT(error_of_image(path), AllOf(HasSubstr("wide.png"), HasSubstr("80x48"), HasSubstr("64x48")));
}

}  // namespace
}  // namespace fabloop
