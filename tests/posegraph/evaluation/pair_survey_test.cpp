// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/pair_survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "frontend/csv_lines.h"
#include "posegraph/evaluation/pair_survey_csv.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/posegraph/tiny_map.h"

namespace fabloop {
namespace {

using testing_support::read_tiny_sequence;
using testing_support::tiny_map_options;

/// Every third frame: enough to have pairs of all kinds, few enough to be quick.
Sequence thinned(Sequence sequence) {
  std::vector<Frame> kept;
  for (std::size_t i = 0; i < sequence.frames.size(); i += 3) kept.push_back(sequence.frames[i]);
  sequence.frames = std::move(kept);
  return sequence;
}

PairSurveyOptions tiny_survey_options() {
  PairSurveyOptions options;
  options.features = tiny_map_options().features;
  return options;
}

LoopTruth truth_of(const Sequence& sequence) {
  LoopTruth truth;
  for (const Frame& frame : sequence.frames) truth.world_from_camera.push_back(frame.world_from_camera);
  return truth;
}

TEST(PairSurvey, MeetsEveryPairOnce) {
  const Sequence sequence = thinned(read_tiny_sequence());
  const auto pairs = survey_pairs({sequence, sequence}, tiny_survey_options());
  const std::size_t n = 2 * sequence.frames.size();
  EXPECT_EQ(pairs.size(), n * (n - 1) / 2);
  for (const SurveyedPair& pair : pairs) {
    EXPECT_TRUE(pair.query.sequence > pair.match.sequence ||
                (pair.query.sequence == pair.match.sequence && pair.query.frame > pair.match.frame));
  }
}

TEST(PairSurvey, DoesNotDependOnTheNumberOfThreads) {
  const Sequence sequence = thinned(read_tiny_sequence());
  PairSurveyOptions options = tiny_survey_options();
  options.num_threads = 1;
  const auto one = survey_pairs({sequence}, options);
  options.num_threads = 3;
  const auto three = survey_pairs({sequence}, options);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].verification.verdict, three[i].verification.verdict) << i;
    EXPECT_EQ(one[i].verification.match_from_query.translation, three[i].verification.match_from_query.translation) << i;
  }
}

TEST(PairSurvey, AskedForSomePairsMakesTheSameOfThem) {
  const Sequence sequence = thinned(read_tiny_sequence());
  PairSurveyOptions options = tiny_survey_options();
  options.max_neighbour_distance = 1;  // so that not all frames need be seen
  const auto every = survey_pairs({sequence, sequence}, options);
  options.only = std::vector<AskedPair>{{{0, 6}, {0, 0}}, {{0, 6}, {0, 5}}, {{1, 6}, {0, 6}}};
  const auto some = survey_pairs({sequence, sequence}, options);
  ASSERT_GE(sequence.frames.size(), 8U);
  ASSERT_EQ(some.size(), 3U);
  for (const SurveyedPair& pair : some) {
    const auto same = std::find_if(every.begin(), every.end(), [&](const SurveyedPair& other) {
      return other.query == pair.query && other.match == pair.match;
    });
    ASSERT_NE(same, every.end());
    EXPECT_EQ(same->verification.verdict, pair.verification.verdict);
    EXPECT_EQ(same->verification.num_point_inliers, pair.verification.num_point_inliers);
    EXPECT_EQ(same->verification.match_from_query.translation, pair.verification.match_from_query.translation);
  }
}

TEST(PairSurvey, CountsWhatItFindsAmongTheAskedPairs) {
  const Sequence sequence = thinned(read_tiny_sequence());
  LoopTruth truth = truth_of(sequence);
  truth.pairs = PairTruths{{{0, 1}, {.overlap = 0.5}}, {{0, 2}, {.overlap = 0.5}}, {{0, 3}, {.overlap = 0.2}}};
  PairSurveyOptions options = tiny_survey_options();
  options.only = std::vector<AskedPair>{{{0, 1}, {0, 0}}, {{0, 3}, {0, 0}}};
  const auto summaries = summarise_survey(survey_pairs({sequence}, options), {truth}, {{}});
  EXPECT_EQ(summaries[0].wide.num_pairs, 1U);
  EXPECT_EQ(summaries[0].narrow.num_pairs, 1U);
}

TEST(PairSurvey, WritesWhatItJudgesAndIsAskedForByLinesOfThatFile) {
  Sequence sequence = thinned(read_tiny_sequence());
  sequence.name = "tiny";
  const LoopTruth truth = truth_of(sequence);
  PairSurveyOptions options = tiny_survey_options();
  options.only = std::vector<AskedPair>{{{0, 1}, {0, 0}}, {{0, 2}, {0, 1}}};
  const auto pairs = survey_pairs({sequence}, options);
  const TemporaryFolder folder;
  const auto path = folder.path() / "pairs.csv";
  write_surveyed_pairs(path, pairs, {sequence}, {truth}, {{}});
  EXPECT_EQ(read_asked_pairs(path, {sequence}), *options.only);

  std::vector<CsvFields> lines;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail&) { lines.push_back(fields); });
  ASSERT_EQ(lines.size(), 3U);
  ASSERT_EQ(lines[0].size(), lines[1].size());
  const auto field = [&](const std::string& column) {
    return lines[1][static_cast<std::size_t>(std::find(lines[0].begin(), lines[0].end(), column) - lines[0].begin())];
  };
  const Verification& found = pairs[0].verification;
  const JudgedLoop judged = judge_pair(pairs[0], {truth}, {{}});
  ASSERT_EQ(found.verdict, Verdict::Accepted);
  EXPECT_EQ(field("query"), "1");
  EXPECT_EQ(field("verdict"), "Accepted");
  EXPECT_EQ(field("judgement"), in_words(judged.judgement));
  EXPECT_NEAR(std::stod(field("rotation_error_deg")), judged.rotation_error_deg, 1e-4);
  EXPECT_EQ(field("translation_error_m").empty(), !found.has_scale);
  EXPECT_EQ(field("direction_error_deg").empty(), found.has_scale);
  EXPECT_NEAR(std::stod(field("p_true")), found.p_true, 1e-5);
  EXPECT_EQ(field("inliers"), std::to_string(found.num_inliers));
  EXPECT_NEAR(std::stod(field("qw")), found.match_from_query.rotation.w(), 1e-5);
}

TEST(PairSurvey, TellsSequencesOfOneNameNotApart) {
  Sequence sequence;
  sequence.name = "flight";
  EXPECT_NE(input_error_of([&] { require_distinct_names({sequence, sequence}); }).find("flight"), std::string::npos);
}

TEST(PairSurvey, NamesTheLineThatAsksForWhatIsNotThere) {
  Sequence sequence;
  sequence.name = "tiny";
  sequence.frames.resize(3);
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& line) {
    const auto path = folder.write("only.csv", "query_sequence,query,match_sequence,match\n" + line + "\n");
    return input_error_of([&] { read_asked_pairs(path, {sequence}); });
  };
  EXPECT_EQ(read_asked_pairs(folder.write("only.csv", "tiny,0,tiny,1\n"), {sequence}),
            (std::vector<AskedPair>{{{0, 1}, {0, 0}}}));
  EXPECT_NE(refused("tiny,3,tiny,1").find("only.csv:2"), std::string::npos);
  EXPECT_NE(refused("other,1,tiny,1").find("\"other\""), std::string::npos);
  EXPECT_NE(refused("tiny,1,tiny,1").find("itself"), std::string::npos);
  EXPECT_NE(refused("tiny,1").find("four columns"), std::string::npos);
}

TEST(PairSurvey, AcceptedPairsOfOneFlightAreRightAndAcrossFlightsCountAsFalse) {
  const Sequence sequence = thinned(read_tiny_sequence());
  const LoopTruth truth = truth_of(sequence);
  const auto pairs = survey_pairs({sequence, sequence}, tiny_survey_options());
  LoopEvaluationOptions evaluation;
  evaluation.height_above_ground_m = 30;
  const auto summaries = summarise_survey(pairs, {truth, truth}, {evaluation, evaluation});
  ASSERT_EQ(summaries.size(), 3U);
  EXPECT_GT(summaries[0].num_accepted, 0U);
  EXPECT_EQ(summaries[0].num_false, 0U);
  // The second flight is the first one again: what is accepted across them would be false were they two places.
  EXPECT_GT(summaries[1].num_accepted, 0U);
  EXPECT_EQ(summaries[1].num_false, summaries[1].num_accepted);
}

}  // namespace
}  // namespace fabloop
