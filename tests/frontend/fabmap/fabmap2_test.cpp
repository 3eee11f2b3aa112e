// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "frontend/fabmap/fabmap2_io.h"
#include "frontend/fabmap/hypotheses.h"
#include "frontend/fabmap/place_recognizer.h"

namespace fabloop {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(FABLOOP_SHARED_DATA_DIR) / "fabmap2";

TEST(FabMap2Model, RanksTheTruePartnerOfEachPairFirst) {
  if (!std::filesystem::is_directory(kFolder)) GTEST_SKIP() << "no FAB-MAP 2.0 model in " << kFolder;
  const FabMap2Model model = read_fabmap2(kFolder);
  ASSERT_EQ(model.tree.num_words(), 10000u);
  ASSERT_EQ(model.true_pairs.size(), 5u);
  // The map holds what was seen before the query, as it would online. Their images join five cameras and show three times the
  // words that the tree expects, so the default detector, which never
  // errs, is too sure of itself: it ranks four of the five first. There is no background to tell p(new) with.
  const DetectorModel detector = {0.5, 0.01};
  for (const auto& [query, match] : model.true_pairs) {
    PlaceRecognizer recognizer(model.tree, detector);
    std::vector<int> image_of_place;
    for (const auto& [image, observation] : model.observations) {
      if (image >= query) break;
      recognizer.add_place(observation);
      image_of_place.push_back(image);
    }
    HypothesesOptions options;
    options.num_recent_excluded = 0;
    const auto ranked = ranked_hypotheses(recognizer.recognize(model.observations.at(query)), options);
    ASSERT_FALSE(ranked.empty());
    EXPECT_EQ(image_of_place[ranked[0].place], match) << "query " << query;
  }
}

}  // namespace
}  // namespace fabloop
