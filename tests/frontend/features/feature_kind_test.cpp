// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_kind.h"

#include <gmock/gmock.h>

#include "frontend/error.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

TEST(FeatureKind, NamesAreInverse) {
  for (const FeatureKind& detector : default_feature_kinds()) {
    for (const FeatureKind& descriptor : default_feature_kinds()) {
      const FeatureKind kind{detector.detector, descriptor.descriptor};
      const std::string name = std::string(to_string(kind.detector)) + "+" + std::string(to_string(kind.descriptor));
      EXPECT_EQ(feature_kind_from_string(name), kind);
      EXPECT_TRUE(feature_kind_from_string(to_string(kind)).has_value()) << name;
    }
  }
  for (const char* name : {"", "harris", "sift+", "+sift", "sift+fast", "sift+sift+sift", "SIFT"}) {
    EXPECT_FALSE(feature_kind_from_string(name).has_value()) << name;
  }
}

TEST(FeatureKind, ADetectorAloneHasItsOwnDescriptorOrAGoodOne) {
  EXPECT_EQ(to_string(*feature_kind_from_string("sift")), "sift");
  EXPECT_EQ(to_string(*feature_kind_from_string("star")), "star+surf");
  EXPECT_EQ(to_string(*feature_kind_from_string("fast")), "fast+brisk");
  EXPECT_EQ(default_feature_kinds().size(), 11u);
  for (const FeatureKind& kind : default_feature_kinds()) EXPECT_NO_THROW(require_sensible(kind));
}

TEST(FeatureKind, APairingWithoutSenseSaysWhatWouldWork) {
  for (const char* name : {"fast+akaze", "sift+kaze", "akaze+kaze", "kaze+akaze"}) {
    const FeatureKind kind = *feature_kind_from_string(name);
    try {
      require_sensible(kind);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
      EXPECT_THAT(error.what(), HasSubstr(std::string(to_string(kind.detector)) + "+sift"));
    }
  }
}

}  // namespace
}  // namespace fabloop
