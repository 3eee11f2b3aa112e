// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <random>
#include <sstream>

#include "frontend/fabmap/precision_recall.h"
#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

/// Prints, for each line "label score label score ..." of a file: average precision, then precision and recall at every threshold
/// from the highest down.
constexpr const char* kProgram = R"(
import sys
from sklearn.metrics import average_precision_score, precision_recall_curve
for line in open(sys.argv[1]):
    numbers = [float(text) for text in line.split()]
    labels, scores = numbers[0::2], numbers[1::2]
    precision, recall, thresholds = precision_recall_curve(labels, scores)
    points = list(zip(thresholds, precision, recall))[::-1]
    print(repr(float(average_precision_score(labels, scores))), *(repr(float(x)) for point in points for x in point))
)";

std::string output_of(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  while (pipe && fgets(buffer, sizeof(buffer), pipe)) output += buffer;
  if (pipe) pclose(pipe);
  return output;
}

TEST(PrecisionRecallCurve, EqualsScikitLearns) {
  if (output_of("/usr/bin/python3 -c 'import sklearn; print(1)' 2>/dev/null") != "1\n") {
    GTEST_SKIP() << "scikit-learn is not installed (Debian: python3-sklearn)";
  }
  const TemporaryFolder folder;
  std::mt19937_64 random(11);
  std::vector<std::vector<Decision>> problems;
  std::ofstream file(folder.path() / "problems.txt");
  file << std::setprecision(17);
  for (std::size_t problem = 0; problem < 40; ++problem) {
    std::vector<Decision> decisions = {{0.5, true}};
    const bool has_ties = problem % 2 == 0;
    for (std::size_t i = 0; i < 10 + 10 * problem; ++i) {
      const double score = std::uniform_real_distribution<double>(0, 1)(random);
      decisions.push_back({has_ties ? std::floor(10 * score) / 10 : score, random() % 3 == 0});
    }
    for (const Decision& decision : decisions) file << (decision.is_true ? 1 : 0) << ' ' << decision.score << ' ';
    file << '\n';
    problems.push_back(decisions);
  }
  file.close();
  std::ofstream(folder.path() / "program.py") << kProgram;
  std::istringstream lines(
      output_of("/usr/bin/python3 " + (folder.path() / "program.py").string() + " " + (folder.path() / "problems.txt").string()));
  for (const auto& decisions : problems) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream numbers(line);
    const auto num_positives = static_cast<std::size_t>(
        std::count_if(decisions.begin(), decisions.end(), [](const Decision& decision) { return decision.is_true; }));
    const PrecisionRecallCurve curve = precision_recall_curve(decisions, num_positives);
    constexpr double kAgreement = 1e-12;
    double average_precision = 0.0;
    numbers >> average_precision;
    EXPECT_NEAR(curve.average_precision, average_precision, kAgreement);
    PrecisionRecallPoint expected;
    std::size_t point = 0;
    // scikit-learn leaves out nothing here, so that the points correspond one by one.
    while (numbers >> expected.threshold >> expected.precision >> expected.recall) {
      ASSERT_LT(point, curve.points.size());
      EXPECT_EQ(curve.points[point].threshold, expected.threshold);
      EXPECT_NEAR(curve.points[point].precision, expected.precision, kAgreement);
      EXPECT_NEAR(curve.points[point].recall, expected.recall, kAgreement);
      ++point;
    }
    EXPECT_EQ(point, curve.points.size());
  }
}

}  // namespace
}  // namespace fabloop
