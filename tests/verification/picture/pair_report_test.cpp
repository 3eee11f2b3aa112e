// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/pair_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/verification/two_view_world.h"
#include "verification/picture/pair_picture.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

const PairFigure& figure_of(const std::vector<PairFigure>& figures, std::string_view name) {
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const PairFigure& figure) { return figure.name == name; });
  EXPECT_NE(found, figures.end()) << name;
  return *found;
}

TEST(PairReport, OfAnAcceptedPairPassesEveryGate) {
  for (const bool with_points : {false, true}) {
    const TwoViews world = make_two_views({.outlier_ratio = 0.2, .noise_px = 0.5, .with_points = with_points});
    const Verification found = Verifier().verify(world.query, world.match);
    ASSERT_EQ(found.verdict, Verdict::Accepted);
    std::set<std::string_view> names;
    for (const PairFigure& figure : pair_figures(world.query, world.match, found, {})) {
      EXPECT_TRUE(figure.is_passed().value_or(true)) << figure.name;
      EXPECT_TRUE(names.insert(figure.name).second) << figure.name << " twice";
      EXPECT_FALSE(figure.explanation.empty());
      EXPECT_TRUE(figure.value || figure.name == "turn_deg" || figure.name == "growth") << figure.name;
    }
    EXPECT_EQ(names.contains("point_inliers"), with_points);
  }
}

TEST(PairReport, FailsTheGateThatTheVerdictNames) {
  const TwoViews few = make_two_views({.num_points = 12});
  const Verification found = Verifier().verify(few.query, few.match);
  ASSERT_EQ(found.verdict, Verdict::TooFewMatches);
  const auto figures = pair_figures(few.query, few.match, found, {});
  EXPECT_EQ(figure_of(figures, "matches").is_passed(), false);
  EXPECT_FALSE(figure_of(figures, "inliers").value) << "no pose was looked for";
  EXPECT_EQ(value_text(figure_of(figures, "inliers")), "-");

  const TwoViews false_pair = make_two_views({.num_points = 40, .outlier_ratio = 0.8, .noise_px = 0.5, .seed = 2});
  const Verification too_few = Verifier().verify(false_pair.query, false_pair.match);
  ASSERT_EQ(too_few.verdict, Verdict::TooFewInliers);
  EXPECT_EQ(figure_of(pair_figures(false_pair.query, false_pair.match, too_few, {}), "inliers").is_passed(), false);
}

TEST(PairReport, WritesFiguresForPeople) {
  PairFigure figure{"inliers", "", 214.0, PairFigure::Wanted::AtLeast, 15};
  EXPECT_EQ(value_text(figure), "214");
  EXPECT_EQ(wanted_text(figure), "at least 15");
  figure.value = 0.123456;
  figure.wanted = PairFigure::Wanted::AtMost;
  EXPECT_EQ(value_text(figure), "0.1235");
  EXPECT_EQ(wanted_text(figure), "at most 15");
  figure.wanted = PairFigure::Wanted::Anything;
  EXPECT_EQ(wanted_text(figure), "");
  EXPECT_FALSE(figure.is_passed());
}

TEST(PairReport, EveryVerdictHasAMeaning) {
  for (int verdict = 0; verdict <= static_cast<int>(Verdict::ContradictsMap); ++verdict) {
    EXPECT_FALSE(meaning_of(static_cast<Verdict>(verdict)).empty()) << verdict;
  }
}

/// Pixels that are much more of the one colour than of the others.
int count_coloured(const cv::Mat& picture, int channel) {
  int count = 0;
  for (const cv::Vec3b& pixel : cv::Mat3b(picture)) {
    count +=
        pixel[channel] > 120 && pixel[channel] > 2 * pixel[(channel + 1) % 3] && pixel[channel] > 2 * pixel[(channel + 2) % 3];
  }
  return count;
}

TEST(PairPicture, ShowsInliersGreenTheOthersRedAndLinesOnlyOfAPose) {
  const TwoViews world = make_two_views({.num_points = 60, .outlier_ratio = 0.4, .noise_px = 0.5});
  const Verification found = Verifier().verify(world.query, world.match);
  ASSERT_EQ(found.verdict, Verdict::Accepted);
  const auto matches = match_features(world.query.features, world.match.features);
  const cv::Mat1b gray(480, 640, 100);
  const auto draw = [&](const Verification& verification) {
    return draw_pair({world.query, world.match, gray, gray, "a", "b", matches, verification, {"remark"}, {}});
  };
  const cv::Mat picture = draw(found);
  EXPECT_EQ(picture.type(), CV_8UC3);
  EXPECT_GT(count_coloured(picture, 1), 100);
  EXPECT_GT(count_coloured(picture, 2), 100);
  const cv::Mat without = draw(Verification{});
  EXPECT_LT(without.rows, picture.rows - 400) << "lines of no pose";
  EXPECT_EQ(count_coloured(without, 1), 0);
}

}  // namespace
}  // namespace fabloop
