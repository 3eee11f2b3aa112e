// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/exif.h"

#include "tests/frontend/sequence/exif_jpeg.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

/// 4 mm on a sensor 6 mm and 4000 px wide: fx is 2/3 of the image's width.
ExifFields sensor_fields() {
  return {.focal_length_um = 4000, .focal_length_35mm = 0, .pixel_x_dimension = 4000, .pixels_per_metre = 4000 * 1000 / 6};
}

TEST(Exif, FocalLengthFollowsFromTheSensorsWidth) {
  const TemporaryFolder folder;
  const auto camera = camera_from_exif(folder.write("a.jpg", jpeg_with_exif(sensor_fields())), 1200, 900);
  ASSERT_TRUE(camera.has_value());
  EXPECT_NEAR(camera->fx, 800, 0.1);
  EXPECT_EQ(camera->fx, camera->fy);
  EXPECT_EQ(camera->cx, 599.5);
  EXPECT_EQ(camera->cy, 449.5);
  EXPECT_TRUE(camera->distortion.empty());
}

TEST(Exif, FocalLengthFollowsFromThe35MillimetreEquivalent) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.jpg", jpeg_with_exif({.focal_length_um = 4000, .focal_length_35mm = 26}));
  const auto camera = camera_from_exif(path, 1200, 900);
  ASSERT_TRUE(camera.has_value());
  EXPECT_NEAR(camera->fx, 26.0 / 43.2666 * 1500.0, 0.01);
}

TEST(Exif, The35MillimetreEquivalentWinsWhenTheImageWasResized) {
  const TemporaryFolder folder;
  ExifFields fields = sensor_fields();
  fields.focal_length_35mm = 24;
  EXPECT_NEAR(camera_from_exif(folder.write("whole.jpg", jpeg_with_exif(fields)), 1200, 900)->fx, 800, 0.1);
  fields.pixel_x_dimension = 1200;
  EXPECT_NEAR(camera_from_exif(folder.write("resized.jpg", jpeg_with_exif(fields)), 1200, 900)->fx, 832.05, 0.1);
}

TEST(Exif, NoneWithoutUsableFields) {
  const TemporaryFolder folder;
  EXPECT_FALSE(camera_from_exif(folder.write("plain.jpg", encoded_image(".jpg")), 64, 48).has_value());
  EXPECT_FALSE(camera_from_exif(folder.write("zero.jpg", jpeg_with_exif({.focal_length_um = 4000})), 64, 48).has_value());
  EXPECT_FALSE(camera_from_exif(folder.path() / "absent.jpg", 64, 48).has_value());
  auto cut = jpeg_with_exif(sensor_fields());
  cut.resize(60);
  EXPECT_FALSE(camera_from_exif(folder.write("cut.jpg", cut), 64, 48).has_value());
}

TEST(Exif, NamesTheCameraAndItsFocalLength) {
  const TemporaryFolder folder;
  ExifFields fields{.focal_length_um = 4500, .make = "Canon", .model = "Canon PowerShot SX260 HS "};
  const auto label = camera_label_from_exif(folder.write("a.jpg", jpeg_with_exif(fields)));
  ASSERT_TRUE(label.has_value());
  EXPECT_EQ(label->make, "Canon");
  EXPECT_EQ(label->model, "Canon PowerShot SX260 HS");
  EXPECT_EQ(label->focal_mm, 4.5);
  EXPECT_EQ(to_string(*label), "Canon PowerShot SX260 HS at 4.5 mm");
  EXPECT_EQ(to_string(CameraLabel{"DJI", "FC300S", {}}), "DJI FC300S");
  EXPECT_EQ(to_string(CameraLabel{"DJI", "", {}}), "DJI");
  EXPECT_FALSE(camera_label_from_exif(folder.write("b.jpg", jpeg_with_exif(sensor_fields()))).has_value());
  EXPECT_FALSE(camera_label_from_exif(folder.write("c.jpg", encoded_image(".jpg"))).has_value());
}

}  // namespace
}  // namespace fabloop
