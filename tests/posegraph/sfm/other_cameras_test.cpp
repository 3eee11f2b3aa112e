// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/other_cameras.h"

#include <gmock/gmock.h>

namespace fabloop {
namespace {

using ::testing::HasSubstr;

using Labels = std::vector<std::optional<CameraLabel>>;

const CameraLabel kCanon{"Canon", "Canon SX260", 4.5};
const CameraLabel kPhone{"Maker", "Phone", 4.3};

TEST(OtherCameras, AreThoseThatFewerImagesName) {
  const auto why = other_cameras(Labels{kPhone, kCanon, kCanon, std::nullopt, kPhone, kCanon});
  EXPECT_THAT(why[0].value_or(""), HasSubstr("another camera (Maker Phone at 4.3 mm) than most (Canon SX260 at 4.5 mm)"));
  EXPECT_TRUE(why[4].has_value());
  for (const std::size_t i : {1U, 2U, 3U, 5U}) EXPECT_FALSE(why[i].has_value()) << i;
}

TEST(OtherCameras, CountsAnotherZoomAsAnotherCameraButNoRounding) {
  CameraLabel zoomed = kCanon, rounded = kCanon, silent = kCanon;
  zoomed.focal_mm = 5.4;
  rounded.focal_mm = 4.55;
  silent.focal_mm.reset();
  const auto why = other_cameras(Labels{kCanon, rounded, silent, zoomed});
  EXPECT_FALSE(why[1].has_value());
  EXPECT_FALSE(why[2].has_value());
  EXPECT_THAT(why[3].value_or(""), HasSubstr("5.4 mm"));
}

TEST(OtherCameras, DoesNotDependOnWhereTheSilentOnesStand) {
  CameraLabel zoomed = kCanon, silent = kCanon;
  zoomed.focal_mm = 9.0;
  silent.focal_mm.reset();
  const auto why = other_cameras(Labels{silent, kCanon, kCanon, zoomed});
  for (const std::size_t i : {0U, 1U, 2U}) EXPECT_FALSE(why[i].has_value()) << i;
  EXPECT_THAT(why[3].value_or(""), HasSubstr("9 mm"));
}

TEST(OtherCameras, KnowsNoneWhereNothingIsTold) {
  for (const auto& why : other_cameras(Labels{std::nullopt, std::nullopt})) EXPECT_FALSE(why.has_value());
  EXPECT_TRUE(other_cameras(Labels{}).empty());
  const auto why = other_cameras(Labels{kPhone, kCanon});  // of two equal groups the first counts
  EXPECT_FALSE(why[0].has_value());
  EXPECT_TRUE(why[1].has_value());
}

}  // namespace
}  // namespace fabloop
